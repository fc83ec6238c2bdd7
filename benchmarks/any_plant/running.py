"""Hidden effects on the other machines of tests/truth: each case is imported and diagnosed as a user would; docs/any_plant.md.

`make any_plant` goes on where it stopped: finished cases stand in the ledger, one line each, by version of the code.
"""

from __future__ import annotations

import argparse
import json
import random
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from truth.axis.case import write_axis_case
from truth.axis.hidden import FORMS as AXIS_FORMS
from truth.hidden_form import NOTHING, Form
from truth.servo.case import write_pendulum_case, write_servo_case
from truth.servo.hidden import ROPE_FORMS, SERVO_FORMS
from truth.tanks.case import write_tanks_case
from truth.tanks.hidden import FORMS as TANKS_FORMS

from benchmarks import ROOT
from benchmarks.any_plant.judging import outcome, page
from benchmarks.hidden_effects.ledger import Ledger, code_version

MACHINES: dict[str, tuple[Callable[..., Path], tuple[Form[Any], ...]]] = {
    "axis": (write_axis_case, AXIS_FORMS),
    "tanks": (write_tanks_case, TANKS_FORMS),
    "servo": (write_servo_case, SERVO_FORMS),
    "pendulum": (write_pendulum_case, ROPE_FORMS),
}
PLAN = "any_plant/1"
NULLS = 10  # for each case of a form
LONGEST_S = 3600.0


@dataclass(frozen=True)
class AnyCase:
    """One case: machine, effect, form, seed, and whether there is one log without repetitions."""

    plant: str
    effect: str
    form: str
    seed: int
    one_log: bool

    @property
    def name(self) -> str:
        """The name in the ledger."""
        return f"{self.plant}/{self.effect}/{self.form}/{self.seed}/{'one' if self.one_log else 'repeated'}"


def cases(plants: list[str], count: int, shift: int) -> Iterator[AnyCase]:
    """Yield the cases, one round over all forms and plants after the other, each rig with a seed of its own.

    A round is in an order drawn at random, so that an unfinished one is even over plants and forms. One log and repetitions
    take turns.
    """
    for turn in range(count):
        found = []
        for plant in plants:
            forms = [*MACHINES[plant][1], *[NOTHING] * NULLS]
            for number, form in enumerate(forms):
                seed = shift + turn * 1000 + number
                found.append(AnyCase(plant, form.effect, form.name, seed, (turn + number) % 2 == 0))
        random.Random(shift + turn).shuffle(found)
        yield from found


def hjcamp(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the program in a folder, as a user does."""
    command = [sys.executable, "-m", "hjcamp", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=LONGEST_S, check=False)


def run_case(case: AnyCase, effort: str, strength: str, write: Callable[..., Path], plan: str = PLAN) -> dict[str, Any]:
    """Write, import and diagnose one case, and return its line of the ledger."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        answer = write(folder, case.effect, case.form, case.seed, case.one_log, strength=strength)
        truth = json.loads(answer.read_text(encoding="utf-8"))
        answer.unlink()  # nobody can look it up
        start = time.monotonic()
        message, said = "", {}
        files = sorted(str(file.relative_to(folder)) for file in (folder / "measured").iterdir())
        imported = hjcamp(folder, "import", *files, "--map", "import.yaml", "--into", "logs")
        call = imported
        if imported.returncode == 0:
            call = hjcamp(folder, "diagnose", "logs", "--json", "answer.json", "--effort", effort, "--workers", "1")
            if call.returncode == 0:
                said = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
        if call.returncode:
            message = " ".join(call.stderr.split())[-300:] or f"exit code {call.returncode}"
    verdict, effects = said.get("verdict", "failed"), said.get("effects", [])
    return {
        "plan": plan,
        "name": case.name,
        "effort": effort,
        "tag": code_version(),
        "truth": truth,
        "verdict": verdict,
        "effects": effects,
        "drivers": said.get("drivers", []),
        "law_left": said.get("law_left"),
        "outcome": outcome(truth, verdict, effects),
        "message": message,
        "seconds": round(time.monotonic() - start, 1),
    }


def main(arguments: list[str] | None = None) -> int:
    """Run what is not in the ledger yet, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plants", nargs="+", choices=list(MACHINES), default=list(MACHINES))
    parser.add_argument("--count", type=int, default=2, help="rounds over all forms")
    parser.add_argument("--limit", type=int, help="stop after so many new cases")
    parser.add_argument("--shift", type=int, default=700_000, help="first seed")
    parser.add_argument("--effort", default="standard", choices=["quick", "standard", "thorough"])
    parser.add_argument("--strength", default="medium")
    parser.add_argument("--ledger", type=Path, default=ROOT / "benchmarks" / "results" / "any_plant.jsonl")
    parser.add_argument("--page", type=Path)
    options = parser.parse_args(arguments)
    ledger, tag = Ledger(options.ledger, PLAN), code_version()
    wanted = list(cases(options.plants, options.count, options.shift))
    finished = ledger.finished(tag, options.effort)
    for case in [case for case in wanted if case.name not in finished][: options.limit]:
        line = run_case(case, options.effort, options.strength, MACHINES[case.plant][0])
        ledger.add(line)
        print(f"{line['name']:60} {line['outcome']:12} {', '.join(line['effects'])} {line['message'][:80]}", flush=True)
    if options.page:
        names = {case.name for case in wanted}
        lines = [line for line in ledger.lines(tag) if line["effort"] == options.effort and line["name"] in names]
        command = "python -m benchmarks.any_plant " + shlex.join(arguments if arguments is not None else sys.argv[1:])
        options.page.write_text(page(lines, tag, command), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
