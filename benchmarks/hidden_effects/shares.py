"""The measures of the hidden-effect benchmark that count verdicts and names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from benchmarks.hidden_effects.cases import EFFECT, NOTHING, ONE_OF, OUTSIDE
from benchmarks.hidden_effects.judging import Line, detectable, first_is_true, is_true, matched, named, right, verdict_of
from benchmarks.hidden_effects.measure import Measure, at_least, at_most, counted, share


def naming(singles: Sequence[Line], nulls: Sequence[Line]) -> list[Measure]:
    """Return how often the right effect comes first, the verdict is exactly right, and something is named on a null."""
    seen = [line for line in singles if detectable(line)]
    first, exact = at_least("41 of 42", 95, 98), at_least("31 - 38 of 48", 85, 93)
    return [
        share("right effect first, where detectable", seen, lambda line: first_is_true(line, False), first),
        share("... the same thing counted as right", seen, lambda line: first_is_true(line, True), first),
        share("exactly the right verdict: that effect alone; all strengths", singles, lambda x: right(x, False), exact),
        share("... where detectable", seen, lambda line: right(line, False), exact),
        share("... with groups, and nothing where not detectable; all strengths", singles, right, exact),
        share("... with groups, where detectable", seen, right, exact),
        share("nulls in which something is named", nulls, lambda x: bool(named(x)), at_most("0 - 1 of 16", 8, 5)),
        share("... in which anything but nothing_missing is said", nulls, lambda x: verdict_of(x) != NOTHING),
    ]


def names(inside: Sequence[Line], every: Sequence[Line]) -> list[Measure]:
    """Return how many of the names given are wrong: ``inside`` the library and on nulls, and in ``every`` case."""

    def wrong(lines: Sequence[Line], groups: bool) -> tuple[int, int, tuple[tuple[str, int], ...]]:
        given = [(line, name) for line in lines if verdict_of(line) == EFFECT for name in named(line)]
        bad = Counter(name for line, name in given if not is_true(name, line, groups))
        return bad.total(), len(given), tuple(bad.most_common())

    aim = at_most("0 of 31", 3, 1)
    found = []
    for title, lines, groups in (
        ("wrong name among all names given with certainty; library and nulls", inside, True),
        ("... the other name of the same thing counted as wrong", inside, False),
        ("... outside the library too", every, True),
    ):
        hits, total, spoiled = wrong(lines, groups)
        found.append(counted(title, hits, total, aim, spoiled))
    several = [line for line in inside if verdict_of(line) == ONE_OF]
    return [*found, share("one of several without the true one", several, lambda x: not _contains(x))]


def _contains(line: Line) -> bool:
    return any(is_true(name, line, True) for name in named(line))


def outside(lines: Sequence[Line]) -> list[Measure]:
    """Return what is said where the true effect is not in the library."""

    def said_so(line: Line) -> bool:
        return verdict_of(line) == OUTSIDE

    def driver(line: Line) -> bool:
        drivers = line["answer"]["drivers"] if "answer" in line else []
        return bool(drivers) and drivers[0] in line["truth"]["drivers"]

    def certain(line: Line) -> bool:
        return verdict_of(line) == EFFECT

    seen = [line for line in lines if detectable(line)]
    never = [line for line in seen if line["kind"] == "outside"]
    taken = [line for line in seen if line["kind"] == "taken_out"]
    so, which, name = at_least("8 of 8", 85, 95), at_least("7 of 8", 80, 90), at_most("0 of 8", 10, 3)
    return [
        share("outside the library: said so, where detectable", seen, said_so, so),
        share("... effects that were never in it", never, said_so, so),
        share("... effects taken out of it", taken, said_so, so),
        share("... all strengths", lines, said_so),
        share("... right driver first (never in it, detectable)", never, driver, which),
        share("... right driver first, where it was said", [line for line in never if said_so(line)], driver, which),
        share("... a name with certainty, all strengths", lines, certain, name),
        share("... a name with certainty, never in it", [x for x in lines if x["kind"] == "outside"], certain, name),
        share("... a name with certainty, taken out", [x for x in lines if x["kind"] == "taken_out"], certain, name),
    ]


def pairs(lines: Sequence[Line]) -> list[Measure]:
    """Return how often two hidden effects are both found."""

    def both(line: Line) -> bool:
        return verdict_of(line) == EFFECT and matched(line, True)

    def none_wrong(line: Line) -> bool:
        names = named(line)
        return verdict_of(line) == EFFECT and bool(names) and all(is_true(name, line, True) for name in names)

    return [
        share("two effects, exactly both", lines, both, at_least("6 of 6", 80, 95)),
        share("... at least one right, none wrong", lines, none_wrong),
    ]
