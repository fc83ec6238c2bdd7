"""The page of the levels: what stands in their tables, at these and at other thresholds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy.special import stdtrit

from benchmarks import ROOT
from benchmarks.hidden_effects.measure import wilson
from hjcamp.plants.pump_joint.diagnosis.levels import (
    CHANNELS,
    LEVEL,
    chance,
    exact,
    law,
    laws_off,
    least_gain,
    margin,
    off_of,
    promises_a_test,
    second_gain,
    second_gains,
    spoken_against,
    times_asked,
    times_usual,
    usual_gain,
)
from hjcamp.plants.pump_joint.diagnosis.levels.forms import COVERED, form_of
from hjcamp.plants.pump_joint.diagnosis.selection.verdict import AGAINST

FRESH = ROOT / "benchmarks" / "results" / "levels_fresh.csv"
ASKED = (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
SECONDS = (0.2, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6)
MARGINS = (1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3)
SHARES = (0.02, 0.05, 0.1, 0.2, 0.5)
LAWS = (0.0, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0)
Rows = Sequence[Mapping[str, Any]]


def page(known: Rows, fresh: Rows, effects: Rows, intervals: Rows) -> str:
    """Return the page: thresholds, operating curves, contacts, how often chance is as small as it says, laws and intervals."""
    parts = [
        HEAD.format(
            count=len(known), tests=known[0]["tests"], level=LEVEL, gain=times_asked(), margin=margin(), law=law(),
            second=second_gain(1), effects=sum(row["known"] == "1" for row in effects),
            outside=sum(row["known"] == "0" for row in effects),
        )
    ]  # fmt: skip
    sets = {"these rigs": known} | ({"fresh rigs": fresh} if fresh else {})
    return "\n".join(
        [*parts, *of_thresholds(sets, int(known[0]["tests"])), *of_answers(sets), *of_laws(effects), *of_intervals(intervals)]
    )


def of_thresholds(sets: Mapping[str, Rows], tests: int) -> list[str]:
    """Return the tables of rigs with nothing missing by what is asked: of an effect's gain, and of the margin on null replicates."""
    return [
        table(
            "named where nothing is missing, by how many times its usual gain an effect is asked",
            ["times", *sets],
            (
                [f"{asked:.3g}", *(share(times_usual(rows) >= asked) for rows in sets.values())]
                for asked in sorted([*ASKED, times_asked()])
            ),
        ),
        table(
            f"what each effect gains on rigs with nothing missing, and what it is asked, in {tests} tests",
            ["effect", "promises on average", "usual", "asked"],
            (
                [
                    name,
                    *(f"{gain:.2g}" for gain in (max(tests * promised, 0.0), usual_gain(name, tests), least_gain(name, tests))),
                ]
                for name, promised in sorted(promises_a_test().items(), key=lambda row: -row[1])
            ),
        ),
        table(
            "called outside where nothing is missing, by the margin on the limit of the null replicates",
            ["margin", *sets],
            (
                [f"{asked:.4g}", *(share(over(rows) > asked) for rows in sets.values())]
                for asked in sorted([*MARGINS, margin()])
            ),
        ),
    ]


def of_answers(sets: Mapping[str, Rows]) -> list[str]:
    """Return the tables of what is reported of rigs with nothing missing: how small chance is, and the verdict by contact."""
    return [
        table(
            "chance: the share of rigs whose p is at most as large, by null replicates alone and as reported",
            ["p at most", *(f"{kind}, {name}" for name in sets for kind in ("null replicates", "reported"))],
            (
                [f"{p:g}", *(share(found <= p) for rows in sets.values() for found in (replicates(rows), told(rows)))]
                for p in SHARES
            ),
        ),
        table(
            "verdicts by contact",
            ["rigs", "contact", "nothing missing", "effect or one of", "outside"],
            (
                [name, contact, *(share(np.isin(verdicts(rows, contact), said)) for said in SAID)]
                for name, rows in sets.items()
                for contact in [*sorted({row["contact"] for row in rows}), "all"]
            ),
        ),
    ]


def of_laws(effects: Rows) -> list[str]:
    """Return the tables of rigs with one effect: both errors by how far a law may be off, and what a second effect gains."""
    off, others = laws_off()
    seconds = second_gains()
    laws = table(
        "called outside though the right effect was found, and named though the library has none, by the share that a law may be off",
        ["share", "called outside", "named"],
        ([f"{asked:.3g}", share(off > asked), share(others <= asked)] for asked in sorted([*LAWS, law()])),
    )
    second = table(
        "a second effect beside a right one, by the gain asked of a test",
        ["gain a test", "rigs with one effect"],
        ([f"{asked:.3g}", share(seconds >= asked)] for asked in sorted([*SECONDS, second_gain(1)])),
    )
    by_effect = table(
        "rigs with one effect, by effect",
        ["effect", "found first", "law off by (largest)", "verdicts"],
        (
            [
                effect,
                share(np.array([row["found"] == effect for row in rows])),
                _largest(rows, effect),
                ", ".join(f"{said.replace('_', ' ')} {count}" for said, count in Counter(r["verdict"] for r in rows).items()),
            ]
            for effect, rows in _by(effects, "effect").items()
        ),
    )
    spoken = {kind: (exact(kind), *spoken_against(kind)) for kind in AGAINST}
    of_exact = table(
        "what speaks against a law that is exact, and rigs on which the law found is",
        ["what", "up to", "called outside though its effect is there", "named though another is there"],
        (
            [
                AGAINST[kind].format(effect="the effect", driver="its driver"),
                f"{most:.3g}",
                share(own > most),
                share(others <= most),
            ]
            for kind, (most, own, others) in spoken.items()
        ),
    )
    return [laws, of_exact, second, by_effect]


def _largest(rows: Rows, effect: str) -> str:
    found = [row for row in rows if row["found"] == effect or row["known"] == "0"]
    return f"{float(np.max(off_of(found))):.2g}" if found else ""


def of_intervals(intervals: Rows) -> list[str]:
    """Return the table of what the form of laws adds to each interval, and how many hold the truth without and with it."""
    rows = []
    for (effect, name), own in sorted(_by(intervals, "effect", "parameter").items()):
        error, deviation, reach = (np.array([float(row[key]) for row in own]) for key in ("error", "deviation", "freedom"))
        reach = np.array([stdtrit(one, 0.975) for one in reach])
        form = form_of(effect, name)
        held = [share(np.abs(error) <= reach * np.hypot(deviation, one)) for one in (0.0, form)]
        half = 100 * float(np.median(reach * np.hypot(deviation, form)))
        rows.append([f"{effect} {name}".strip(), *held, f"{100 * form:.2g} %", f"{half:.2g} %"])
    head = [
        "parameter",
        "by the jackknife alone",
        f"with the form of laws ({100 * COVERED:g} % asked)",
        "form",
        "half width, median",
    ]
    return [table("intervals that hold the truth, where the effect alone was named", head, rows)]


def _by(rows: Rows, *keys: str) -> dict[Any, list[Mapping[str, Any]]]:
    found: dict[Any, list[Mapping[str, Any]]] = {}
    for row in rows:
        found.setdefault(row[keys[0]] if len(keys) == 1 else tuple(row[key] for key in keys), []).append(row)
    return found


SAID = (["nothing_missing"], ["effect", "one_of"], ["outside_library"])
HEAD = """# Levels of the joint's verdict

Made by `make levels`; no line is written by hand. {count} rigs of another program (`tests/truth`), each with one of four laws of
dry contact and nothing missing, are diagnosed with the whole library, {tests} tests each. Some effects take up what a contact
leaves that is off in form, others hardly, so that a gain counts by what that effect promises on these rigs on average. The best
effect gains {gain:.3g} times that, and more than 95 % of the rig's own null replicates, on a share of {level:g} of them: so much
is asked before an effect is named. The same share leaves {margin:.3g} times what 95 % of their null replicates leave: a model that
leaves more is outside the library. Both together are one rig in twenty. The table is
`hjcamp/plants/pump_joint/diagnosis/levels/nulls.csv`, from which the program reads both numbers. Intervals are Wilson's, 95 %.
Verdicts are those of the code that made each table; the levels come from it.

{effects} further rigs have one effect of the library each, under one of several laws, and {outside} an effect that is in none
(`effects.csv`). A named law may be off by {law:.3g} of what it explains: there the share of the former that is called outside and
the share of the latter that is named are least together; so are three numbers for a law that is exact, of one effect. A second
effect is asked {second:.3g} a test where the first leaves what its law may: {level:g} of the rigs with one effect gain more. What
the form of laws adds to intervals makes 95 % of them hold the truth (`intervals.csv`); an effect of which too few amplitudes can be
compared has that of all effects together.
"""


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table with its title."""
    lines = [f"## {title[0].upper()}{title[1:]}", "", f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows), ""])


def over(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return what is left over the limit of the twins in the worst channel (rigs,)."""
    return np.array([max(float(row[name]) for name in CHANNELS) for row in rows])


def replicates(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return the chance by twins alone (rigs,)."""
    return np.array([float(row["twins_p"]) for row in rows])


def told(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return the chance that an answer tells (rigs,): the larger of that by twins and that by rigs with other contacts."""
    by_rigs = [chance(row["best"], float(row["gain"]), int(row["tests"])) for row in rows]
    return np.maximum(replicates(rows), by_rigs)


def verdicts(rows: Sequence[Mapping[str, Any]], contact: str) -> Any:
    """Return the verdicts of the rigs with one contact, or of all."""
    return np.array([row["verdict"] for row in rows if contact in ("all", row["contact"])])


def share(said: Any) -> str:
    """Return how many of how many, with Wilson's interval."""
    count, number = int(np.sum(said)), len(said)
    low, high = wilson(count, number)
    return f"{count} of {number} ({low:.0f} - {high:.0f} %)"
