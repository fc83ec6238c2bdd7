"""How an answer of `hjcamp diagnose` on a machine of tests/truth is judged, and the page of the results."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from benchmarks.hidden_effects.measure import wilson
from benchmarks.hidden_effects.tables import table

Line = dict[str, Any]
OUTCOMES = {
    "right": "exactly right",
    "honest": "honest one of",
    "alike": "a name that is the same on these logs",
    "false": "false name",
    "outside": "outside said",
    "nothing": "nothing said",
    "cannot_tell": "cannot tell",
    "failed": "no answer",
}


def outcome(truth: Line, verdict: str, effects: Sequence[str]) -> str:
    """Return what an answer is: a key of OUTCOMES.

    A name is false unless it is the hidden kind or one that the logs cannot tell from it; "one of" is honest where the
    right one, or one like it, is among the names. What should be said where nothing hides is "nothing".
    """
    right, similar, said = set(truth["effects"]), set(truth["alike"]), set(effects)
    if verdict == "one_of":
        return "honest" if said & (right | similar) else "false"
    if verdict == "effect":
        if said == right:
            return "right"
        return "alike" if said and said <= right | similar else "false"
    return {"outside_library": "outside", "nothing_missing": "nothing", "cannot_tell": "cannot_tell"}.get(verdict, "failed")


def good(line: Line) -> bool:
    """Whether the answer is right: the name or an honest "one of", "outside" where no law has it, nothing where it hides."""
    wanted = {"effect": ("right", "honest"), "outside_library": ("outside",), "nothing_missing": ("nothing",)}
    return line["outcome"] in wanted[line["truth"]["verdict"]]


def share(lines: Sequence[Line], hits: Iterable[bool]) -> str:
    """Return hits of lines with the Wilson interval (95 %)."""
    count = sum(hits)
    if not lines:
        return "-"
    low, high = wilson(count, len(lines))
    return f"{count} of {len(lines)} ({low:.0f} - {high:.0f} %)"


def groups(lines: Sequence[Line]) -> dict[str, list[Line]]:
    """Return the lines by what hides: a law that the program has, a kind in another form, no kind of it, nothing."""
    found: dict[str, list[Line]] = {"law of the library": [], "other form": [], "outside": [], "nothing": []}
    for line in lines:
        truth = line["truth"]
        if truth["verdict"] == "effect":
            found["law of the library" if truth["form_in_library"] else "other form"].append(line)
        else:
            found["outside" if truth["verdict"] == "outside_library" else "nothing"].append(line)
    return found


OPENING = (
    "# Any plant: what is said of hidden effects on other machines",
    "",
    "Made by `make any_plant`; no line is written by hand. The machines of `tests/truth` share no code with the program.",
)


def page(lines: Sequence[Line], tag: str, command: str, opening: Sequence[str] = OPENING) -> str:
    """Return the page: all together, by plant and group, then by form, then what was named falsely."""
    headings = (
        "plant",
        "logs",
        "what hides",
        "right",
        "false name",
        "outside said",
        "nothing said",
        "cannot tell or no answer",
    )
    rows = []
    one, repeated = ([x for x in lines if x["truth"]["one_log"] is kind] for kind in (True, False))
    for logs, chosen in (("one", one), ("repeated", repeated), ("both", lines)):
        rows += [(logs, name, *_cells(group)) for name, group in groups(chosen).items() if group]
    parts = [
        *opening,
        f"Code {tag}, command `{command}`, {len(lines)} cases. Intervals are Wilson's, 95 %.",
        "",
        "## All together",
        "",
        table(headings[1:], [*rows, ("both", "all", *_cells(lines))]),
        "",
        "## By plant",
        "",
    ]
    rows = []
    for plant in sorted({line["truth"]["plant"] for line in lines}):
        for one_log in (True, False):
            chosen = [x for x in lines if x["truth"]["plant"] == plant and x["truth"]["one_log"] == one_log]
            for name, group in groups(chosen).items():
                if group:
                    rows.append((plant, "one" if one_log else "repeated", name, *_cells(group)))
    parts += [table(headings, rows), "", "## By form", ""]
    keys = sorted({(x["truth"]["plant"], x["truth"]["effect"], x["truth"]["form"]) for x in lines})
    rows = []
    for key in keys:
        group = [x for x in lines if (x["truth"]["plant"], x["truth"]["effect"], x["truth"]["form"]) == key]
        rows.append((*key, *_cells(group)))
    parts += [table(("plant", "effect", "form", *headings[3:]), rows), "", "## False names", ""]
    false = [x for x in lines if x["outcome"] == "false"]
    rows = [(x["name"], str(x["truth"].get("contact", "-")), " + ".join(x["effects"])) for x in false]
    parts += [table(("case", "contact", "named"), rows) if rows else "None.", ""]
    failed = [x for x in lines if x["outcome"] == "failed"]
    if failed:
        parts += ["## No answer", "", table(("case", "message"), [(x["name"], x["message"]) for x in failed]), ""]
    return "\n".join(parts)


def _cells(group: Sequence[Line]) -> tuple[str, ...]:
    said = [x["outcome"] for x in group]
    return (
        share(group, map(good, group)),
        share(group, (one == "false" for one in said)),
        share(group, (one == "outside" for one in said)),
        share(group, (one == "nothing" for one in said)),
        share(group, (one in ("cannot_tell", "failed") for one in said)),
    )
