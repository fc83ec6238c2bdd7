"""Diagnose rigs with nothing missing and other contacts, and write what they gain and leave: the levels of the verdict.

    python benchmarks/levels.py [--seeds FIRST COUNT] [--workers N] [--into FILE] [--page FILE] [--score]

The rigs are those of the truth plant (tests/truth), which shares no code with the model; each rig's seed draws its contact.
What is finished stands in FILE.part, and the same command goes on from it; FILE is replaced once all rigs are in. The page shows which
share of rigs would be named or called outside at other thresholds, for the rigs that the levels come from and for fresh ones.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
import numpy as np
from hidden_effects import STOPPED, results
from hidden_effects_cases import HiddenCase
from hidden_effects_measure import wilson

from hjcamp.plants.pump_joint.diagnosis.levels import CHANNELS, LEVEL, TABLE, gains_a_test, least_gain, margin
from hjcamp.storage import write_whole

COLUMNS = ("seed", "contact", "tests", "gain", *CHANNELS, "twins_p", "verdict", "effects", "processor_seconds")
FRESH = Path(__file__).with_name("results") / "levels_fresh.csv"
ASKED = (0.2, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6)
MARGINS = (1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3)
SHARES = (0.02, 0.05, 0.1, 0.2, 0.5)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the rigs that are not in the table, then write the page; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, nargs=2, default=(910_000, 200), metavar=("FIRST", "COUNT"))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--into", type=Path, default=TABLE, metavar="FILE")
    parser.add_argument("--page", type=Path, metavar="FILE")
    parser.add_argument("--score", action="store_true", help="run nothing, write the page of the tables that are there")
    given = parser.parse_args(arguments)
    first, count = given.seeds
    if count < 1 or first < 0 or given.workers < 1:
        parser.error("give a first seed of 0 or more, one rig or more, and one worker or more")
    given.effort, given.tag, given.cluster = "standard", "", None
    part = given.into.with_name(f"{given.into.name}.part")
    rows = [] if given.score else rows_of(part)
    done = {int(row["seed"]) for row in rows}
    left = [] if given.score else [case for case in rigs(first, count) if case.seed not in done]
    try:
        for number, line in enumerate(results(left, given, {case.name: {} for case in left}), start=1):
            if "failure" in line:
                print(f"{line['name']}: {line['failure']}", file=sys.stderr)
                return 1
            rows.append(row_of(line))
            write_table(part, rows)
            print(f"{number} of {len(left)}  rig {rows[-1]['seed']}: {rows[-1]['verdict']}", flush=True)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here")
        return STOPPED
    if left or rows:
        part.replace(given.into)
    if given.page:
        write_whole(given.page, page(rows_of(TABLE), rows_of(FRESH)))
    return 0


def rigs(first: int, count: int) -> list[HiddenCase]:
    """Return rigs with nothing hidden."""
    return [HiddenCase(f"null-{seed}", "null", (), "", seed) for seed in range(first, first + count)]


def row_of(line: Mapping[str, Any]) -> dict[str, Any]:
    """Return what one rig with nothing missing gains at most and leaves, over what 95 % of its twins leave."""
    behind, answer = line["behind"], line["answer"]
    step = behind["steps"][0] if behind["steps"] else None
    gain = max(step["counted"], 0.0) if step else 0.0
    return {
        "seed": line["seed"], "contact": line["contact"], "tests": behind["tests"], "gain": f"{gain:.4g}",
        **{name: f"{over:.4g}" for name, over in zip(CHANNELS, behind["over"], strict=False)},
        "twins_p": f"{step['p_value'] if step else 1.0:.4g}", "verdict": answer["verdict"],
        "effects": "+".join(answer["effects"]), "processor_seconds": f"{line['processor_seconds']:.1f}",
    }  # fmt: skip


def rows_of(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a table; none where there is none."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write_table(path: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Write the rows in the order of their seeds."""
    ordered = sorted(rows, key=lambda row: int(row["seed"]))
    text = "".join(",".join(str(row[name]) for name in COLUMNS) + "\n" for row in ordered)
    write_whole(path, ",".join(COLUMNS) + "\n" + text)


def page(known: Sequence[Mapping[str, Any]], fresh: Sequence[Mapping[str, Any]]) -> str:
    """Return the page: thresholds, operating curves, contacts, and how often chance is as small as it says."""
    parts = [HEAD.format(count=len(known), tests=known[0]["tests"], level=LEVEL, gain=least_gain(1), margin=margin())]
    sets = {"these rigs": known} | ({"fresh rigs": fresh} if fresh else {})
    parts.append(
        table(
            "named where nothing is missing, by the gain asked of a test",
            ["gain a test", *sets],
            (
                [f"{asked:.3g}", *(share(gains(rows) >= asked) for rows in sets.values())]
                for asked in sorted([*ASKED, least_gain(1)])
            ),
        )
    )
    parts.append(
        table(
            "called outside where nothing is missing, by the margin on the limit of the twins",
            ["margin", *sets],
            (
                [f"{asked:.4g}", *(share(over(rows) > asked) for rows in sets.values())]
                for asked in sorted([*MARGINS, margin()])
            ),
        )
    )
    parts.append(
        table(
            "chance: the share of rigs whose p is at most as large, by twins alone and as it is told",
            ["p at most", *(f"{kind}, {name}" for name in sets for kind in ("twins", "told"))],
            (
                [f"{p:g}", *(share(found <= p) for rows in sets.values() for found in (twins(rows), told(rows)))]
                for p in SHARES
            ),
        )
    )
    parts.append(
        table(
            "verdicts by contact",
            ["rigs", "contact", "nothing missing", "effect or one of", "outside"],
            (
                [name, contact, *(share(np.isin(verdicts(rows, contact), said)) for said in SAID)]
                for name, rows in sets.items()
                for contact in [*sorted({row["contact"] for row in rows}), "all"]
            ),
        )
    )
    return "\n".join(parts)


SAID = (["nothing_missing"], ["effect", "one_of"], ["outside_library"])
HEAD = """# Levels of the joint's verdict

Made by `make levels`; no line is written by hand. {count} rigs of another program (`tests/truth`), each with one of four laws of
dry contact and nothing missing, are diagnosed with the whole library, {tests} tests each. A share of {level:g} of them gains {gain:.3g}
a test with its best effect: so much is asked before an effect is named. The same share leaves {margin:.3g} times what 95 % of their
twins leave: a model that leaves more is outside the library. Both together are one rig in twenty. The table is
`hjcamp/plants/pump_joint/diagnosis/levels/nulls.csv`, from which the program reads both numbers. Intervals are Wilson's, 95 %.
Verdicts are those of the code that made each table; the levels come from it.
"""


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table with its title."""
    lines = [f"## {title[0].upper()}{title[1:]}", "", f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows), ""])


def gains(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return the gain a test (rigs,)."""
    return np.array([float(row["gain"]) / int(row["tests"]) for row in rows])


def over(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return what is left over the limit of the twins in the worst channel (rigs,)."""
    return np.array([max(float(row[name]) for name in CHANNELS) for row in rows])


def twins(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return the chance by twins alone (rigs,)."""
    return np.array([float(row["twins_p"]) for row in rows])


def told(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return the chance that an answer tells (rigs,): the larger of that by twins and that by rigs with other contacts."""
    known = np.sort(gains_a_test())
    beyond = len(known) - np.searchsorted(known, gains(rows), side="left")
    return np.maximum(twins(rows), (1 + beyond) / (1 + len(known)))


def verdicts(rows: Sequence[Mapping[str, Any]], contact: str) -> Any:
    """Return the verdicts of the rigs with one contact, or of all."""
    return np.array([row["verdict"] for row in rows if contact in ("all", row["contact"])])


def share(said: Any) -> str:
    """Return how many of how many, with Wilson's interval."""
    count, number = int(np.sum(said)), len(said)
    low, high = wilson(count, number)
    return f"{count} of {number} ({low:.0f} - {high:.0f} %)"


if __name__ == "__main__":
    sys.exit(main())
