"""How the diagnosis of a table is judged, and the page of the results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.hidden_effects.cases import similar
from benchmarks.hidden_effects.measure import wilson
from benchmarks.hidden_effects.tables import table

Line = dict[str, Any]
#: Written by hand: what the failures have in common.
READING = Path(__file__).with_name("reading.md")
#: A table moved by less than this, in deviations, hides nothing that it could show.
VISIBLE = 1.0
KINDS = {"effect": "effect of the library", "outside": "outside the library", "null": "nothing"}


def outcome(line: Line) -> str:
    """Return what an answer is: right, right among several, named something else, or the verdict that it gave.

    Right is the verdict and, for an effect, its name alone (or that of the same thing). A name on the way to
    ``outside_library`` is no claim. ``one_of`` with the hidden effect among its names is counted apart.
    """
    verdict, names = line["verdict"], set(line["effects"])
    if line["kind"] != "effect":
        if verdict == line["right"]:
            return "right"
        return "false name" if verdict in ("effect", "one_of") else verdict
    own = similar(line["effect"])
    if verdict == "effect":
        return "right" if len(names) == 1 and names <= own else "false name" if not names & own else "named with others"
    if verdict == "one_of":
        return "right among several" if names & own else "false name"
    return str(verdict)


def share(lines: Sequence[Line], hit: Callable[[Line], bool]) -> str:
    """Return hits of lines with the Wilson interval (95 %)."""
    if not lines:
        return "-"
    count = sum(map(hit, lines))
    low, high = wilson(count, len(lines))
    return f"{count} of {len(lines)} ({low:.0f} - {high:.0f} %)"


def page(lines: Sequence[Line], planned: int, tag: str, command: str) -> str:
    """Return the page: by what hides, then every case."""
    seconds = sorted(float(line["seconds"]) for line in lines if line.get("seconds"))
    middle = f"{seconds[len(seconds) // 2]:.0f} s" if seconds else "-"
    headings = ("what hides", "right", "right among several", "false name", "outside said", "nothing said", "no answer")
    rows = []
    for kind, words in KINDS.items():
        group = [line for line in lines if line["kind"] == kind]
        visible = [line for line in group if line["visible"] >= VISIBLE]
        for title, chosen in ((words, group), (f"{words}, seen in the table", visible if kind != "null" else [])):
            if chosen:
                rows.append((title, *_cells(chosen)))
    cases = [
        (
            line["name"],
            line["strength"] or "-",
            f"{line['visible']:.1f}" if line["effect"] else "-",
            outcome(line),
            line["verdict"].replace("_", " "),
            ", ".join(line["effects"]) or "-",
        )
        for line in sorted(lines, key=lambda one: (one["kind"], one["name"]))
    ]
    unfinished = "" if len(lines) >= planned else f" **{planned - len(lines)} of them have not been run yet.**"
    return "\n".join(
        [
            "# Tables: what is said of effects that hide behind means and deviations",
            "",
            "Made by `make hidden_tables`; only the reading at the end is written by hand. Rigs and tables are of `tests/truth`,",
            "which shares no code with the program: seven trajectories of thesis 5.2.5 at two preloads under PID, five tests",
            "each, every mean to a hundredth of a degree. The table says what the bench's controller does (`controller.bumpless`).",
            "Nothing was tuned on these cases.",
            "",
            f"Code {tag}, command `{command}`, {len(lines)} of {planned} cases.{unfinished} Intervals are Wilson's, 95 %.",
            f"A diagnosis took {middle} of wall time (median; the machine had other work).",
            "",
            table(headings, rows),
            "",
            f"Seen in the table: the effect moves the means by {VISIBLE:g} or more of (deviation of the mean, a tenth of it), rms,",
            "against the table of the same rig and the same draws without it. A tenth is what the method allows for the form of",
            "a model. Right: the verdict and the name alone; a name with `outside_library` is no claim.",
            "",
            "## Every case",
            "",
            table(("case", "strength", "moves the table by", "outcome", "verdict", "named"), cases),
            "",
            READING.read_text(encoding="utf-8"),
        ]
    )


def _cells(group: Sequence[Line]) -> tuple[str, ...]:
    def said(*words: str) -> str:
        return share(group, lambda line: outcome(line) in words)

    return (
        said("right"),
        said("right among several"),
        said("false name", "named with others"),
        share(group, lambda line: line["verdict"] == "outside_library"),
        share(group, lambda line: line["verdict"] == "nothing_missing"),
        share(group, lambda line: line["verdict"] in ("cannot_tell", "failed")),
    )
