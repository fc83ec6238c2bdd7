"""What is hidden in the machines of this package, imported and diagnosed as a user would; docs/foreign_machines.md.

`make foreign_machines` goes on where it stopped. Seeds 1 to 9 are for whoever changes the method; the page counts others.
"""

from __future__ import annotations

import argparse
import random
import shlex
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from truth.hidden_form import NOTHING

from benchmarks import ROOT
from benchmarks.any_plant.judging import page
from benchmarks.any_plant.running import AnyCase, run_case
from benchmarks.hidden_effects.ledger import Ledger, code_version

from . import accumulator, belt, crane, heater, hysteretic, inductor, levitation, oven, shaft, suspension
from .machine import Machine

KNOWN = (accumulator, belt, crane, heater, hysteretic, inductor, levitation, oven, shaft, suspension)
MACHINES: dict[str, Machine] = {one.MACHINE.name: one.MACHINE for one in KNOWN}
PLAN, EFFORT = "foreign_machines/1", "standard"
FIRST_COUNTED = 1001
OPENING = (
    "# Machines of other people",
    "",
    "Made by `make foreign_machines`; no line is written by hand. The machines of `benchmarks/foreign_machines` share no code",
    "with the program; their plants are as a user would write them from a textbook, base parameters 10 to 40 % off.",
)


def cases(seeds: list[int], machines: list[str]) -> Iterator[AnyCase]:
    """Yield the cases: for each seed every form of every machine and two nulls, one log and repetitions in turns.

    A seed's cases are in an order drawn at random, so that an unfinished round is an even draw.
    """
    for seed in seeds:
        found = []
        for place, name in enumerate(machines):
            for number, form in enumerate((*MACHINES[name].forms, NOTHING)):
                found.append(AnyCase(name, form.effect, form.name, seed, (seed + place + number) % 2 == 0))
            found.append(replace(found[-1], one_log=not found[-1].one_log))
        random.Random(seed).shuffle(found)
        yield from found


def main(arguments: list[str] | None = None) -> int:
    """Run what is not in the ledger yet, then write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.foreign_machines", description=__doc__)
    parser.add_argument("--seeds", nargs="+", type=int, default=[FIRST_COUNTED])
    parser.add_argument("--machines", nargs="+", choices=list(MACHINES), default=list(MACHINES))
    parser.add_argument("--only", default="", help="cases whose name has this in it")
    parser.add_argument("--write", type=Path, help="write the cases into this folder and run nothing")
    parser.add_argument("--ledger", type=Path, default=ROOT / "benchmarks" / "results" / "foreign_machines.jsonl")
    parser.add_argument("--page", type=Path)
    options = parser.parse_args(arguments)
    ledger, tag = Ledger(options.ledger, PLAN), code_version()
    wanted = [case for case in cases(options.seeds, options.machines) if options.only in case.name]
    finished = ledger.finished(tag, EFFORT)
    for case in wanted:
        write = MACHINES[case.plant].write
        if options.write:
            write(options.write / case.name.replace("/", "_"), case.effect, case.form, case.seed, case.one_log)
        elif case.name not in finished:
            line = run_case(case, EFFORT, "1", write, PLAN)
            ledger.add(line)
            said = f"{line['outcome']:11} {line['seconds']:5.0f} s {', '.join(line['effects'])} {line['message'][:80]}"
            print(f"{case.name:50} {said}", flush=True)
    if options.page:
        counted = {case.name for case in wanted if case.seed >= FIRST_COUNTED}
        lines = [line for line in ledger.lines(tag) if line["effort"] == EFFORT and line["name"] in counted]
        command = "python -m benchmarks.foreign_machines " + shlex.join(arguments or sys.argv[1:])
        options.page.write_text(page(lines, tag, command, OPENING), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
