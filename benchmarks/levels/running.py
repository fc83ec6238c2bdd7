"""Diagnose rigs with other contacts, and write what they gain and leave: the levels of the verdict.

    python -m benchmarks.levels [--effects] [--seeds FIRST COUNT] [--workers N] [--into FILE] [--page FILE] [--score]

Nothing is missing on the rigs, or one effect of the library under one of several laws (``--effects``).

The rigs are those of the truth plant (tests/truth), which shares no code with the model; each rig's seed draws its contact.
What is finished stands beside FILE, as .jsonl, and the same command goes on from it; FILE is replaced once all rigs are in. The
page shows which share of rigs would be named or called outside at other thresholds, for those that the levels come from and fresh ones.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from itertools import cycle, product
from pathlib import Path

from truth.pump_joint.hidden import LIBRARY_NAMES, OUTSIDE_NAMES

from benchmarks.hidden_effects.cases import HiddenCase
from benchmarks.hidden_effects.ledger import Ledger, code_version
from benchmarks.hidden_effects.running import STOPPED, results
from benchmarks.levels.page import FRESH, page
from benchmarks.levels.tables import write_tables
from hjcamp.plants.pump_joint.diagnosis.levels import EFFECTS, TABLE, rows_of
from hjcamp.plants.pump_joint.diagnosis.levels.forms import TABLE as INTERVALS
from hjcamp.storage import write_whole

STRENGTHS = ("medium", "strong")
APART = 10_000


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the rigs that are not in the table, then write the page; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--effects", action="store_true", help="hide one effect in each rig")
    parser.add_argument("--seeds", type=int, nargs=2, metavar=("FIRST", "COUNT"))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--into", type=Path, metavar="FILE")
    parser.add_argument("--page", type=Path, metavar="FILE")
    parser.add_argument("--score", action="store_true", help="run nothing, write the page of the tables that are there")
    given = parser.parse_args(arguments)
    given.into = given.into or (EFFECTS if given.effects else TABLE)
    first, count = given.seeds or ((930_000, 264) if given.effects else (910_000, 200))
    if count < 1 or first < 0 or given.workers < 1:
        parser.error("give a first seed of 0 or more, one rig or more, and one worker or more")
    given.effort, given.tag, given.cluster = "standard", code_version(), None
    if not given.score:
        part = Ledger(given.into.with_suffix(".jsonl"))
        if not finished(part, (with_effects if given.effects else rigs)(first, count), given):
            return STOPPED
        write_tables(given.into, part.lines(given.tag), given.effects)
        part.path.unlink()
    if given.page:
        write_whole(given.page, page(rows_of(TABLE), rows_of(FRESH), rows_of(EFFECTS), rows_of(INTERVALS)))
    return 0


def finished(part: Ledger, cases: Sequence[HiddenCase], given: argparse.Namespace) -> bool:
    """Diagnose the rigs that this code has not finished yet; return whether all are in."""
    done = part.finished(given.tag, given.effort)
    left = [case for case in cases if case.name not in done]
    try:
        for number, line in enumerate(results(left, given, {case.name: {} for case in left}), start=1):
            said = line["failure"] if "failure" in line else line["answer"]["verdict"]
            print(f"{number} of {len(left)}  {line['name']}: {said}", flush=True)
            part.add(line)
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here")
        return False
    return True


def rigs(first: int, count: int) -> list[HiddenCase]:
    """Return rigs with nothing hidden."""
    return [HiddenCase(f"null-{seed}", "null", (), "", seed) for seed in range(first, first + count)]


def with_effects(first: int, count: int) -> list[HiddenCase]:
    """Return rigs with one effect of the library each, and as many of each effect outside it from seeds `APART` above.

    All effects come in turn, in each of the strengths that tests should show.
    """
    others = count * len(OUTSIDE_NAMES) // len(LIBRARY_NAMES)
    known = [("single", *kind) for kind in product(STRENGTHS, LIBRARY_NAMES)]
    outside = [("outside", *kind) for kind in product(STRENGTHS, OUTSIDE_NAMES)]
    chosen = [*zip(range(first, first + count), cycle(known), strict=False)]
    chosen += zip(range(first + APART, first + APART + others), cycle(outside), strict=False)
    chosen.sort(key=lambda one: one[0] % APART)
    return [
        HiddenCase(f"{effect}-{strength}-{seed}", kind, (effect,), strength, seed) for seed, (kind, strength, effect) in chosen
    ]


if __name__ == "__main__":
    sys.exit(main())
