"""Hunts on simulated rigs, next to as many tests at random and to a full campaign.

    python -m benchmarks.hunting [--cases N] [--seed 73001] [--only PLANT] [--folder DIR] [--ledger FILE]

A case is a plant with one hidden effect, drawn within a factor of two of the library's own values, with one that the diagnosis is not
told of, or with nothing. *hunt*: one condition, two repetitions, then what `hjcamp hunt` makes. *random*: the same condition, then as
many tests, repeated as often, drawn at random from those that the hunt could have chosen. *full*: five conditions, three repetitions,
one diagnosis. Simulated, since a rig in lockstep gives the same tests; effort quick. What is done is in the ledger and not done again;
``--table`` prints it.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.hunting.rigs import REPETITIONS, REPETITIONS_OF_A_HUNT, Case, cases, write_plant
from hjcamp import cli
from hjcamp.analyses.data import Data, silent
from hjcamp.analyses.diagnosing import Asked, diagnose_plant
from hjcamp.backends.virtual_rig.hidden import hidden_config
from hjcamp.campaign.execution.console import make_console
from hjcamp.campaign.files.provenance import git_label
from hjcamp.campaign.one_run import make_run
from hjcamp.commands.hunting.budget import made_seconds
from hjcamp.configuration.composer import Composer, free
from hjcamp.errors import HjcampError

LEDGER = Path(__file__).parents[1] / "results" / "hunting.jsonl"
STRATEGIES = ("hunt", "random", "full")
EFFORT = "quick"
WORKERS = 1


def main(words: Sequence[str] | None = None) -> int:
    """Run the cases that the ledger has not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=30)
    parser.add_argument("--seed", type=int, default=73001)
    parser.add_argument("--only", default="")
    parser.add_argument("--folder", type=Path, default=Path("hunting_cases"))
    parser.add_argument("--ledger", type=Path, default=LEDGER)
    parser.add_argument("--table", action="store_true", help="print what the ledger holds, and run nothing")
    given = parser.parse_args(words)
    ledger = given.ledger.resolve()
    if given.table:
        print(table_of(rows_of(ledger)))
        return 0
    chosen = [one for one in list(cases())[: given.cases] if not given.only or one.rig.name == given.only]
    for one in chosen:
        done = {(row["case"], row["strategy"], row["seed"]) for row in rows_of(ledger)}
        if all((one.name, strategy, given.seed) in done for strategy in STRATEGIES):
            continue
        folder = (given.folder / f"{given.seed}_{one.name.replace('/', '_')}").resolve()
        write_plant(one.rig, folder)
        before = Path.cwd()
        os.chdir(folder)
        try:
            for strategy in STRATEGIES:
                if (one.name, strategy, given.seed) not in done:
                    add_row(ledger, row_of(one, strategy, given.seed))
        finally:
            os.chdir(before)
    return 0


def rows_of(ledger: Path) -> list[dict[str, Any]]:
    """Return the rows of a ledger; a line that was cut off is none."""
    rows = []
    for line in ledger.read_text(encoding="utf-8").splitlines() if ledger.is_file() else ():
        try:
            rows.append(json.loads(line))
        except ValueError:
            continue
    return rows


def table_of(rows: Sequence[dict[str, Any]]) -> str:
    """Return what rows say of each strategy, the last one of each case: how many are right, the rig time over a full campaign's."""
    last = {(row["case"], row["strategy"]): row for row in rows}
    lines = ["| strategy | cases | right | false names | rig time / full campaign, median |", "|---|---|---|---|---|"]
    for strategy in STRATEGIES:
        own = {case: row for (case, name), row in last.items() if name == strategy}
        shares = [row["rig_s"] / full for case, row in own.items() if (full := last.get((case, "full"), {}).get("rig_s"))]
        right, false = (sum(bool(row[key]) for row in own.values()) for key in ("right", "false_name"))
        share = f"{np.median(shares):.2f} ({len(shares)} cases)" if shares else "-"
        lines.append(f"| {strategy} | {len(own)} | {right} | {false} | {share} |")
    return "\n".join(lines)


def add_row(ledger: Path, row: dict[str, Any]) -> None:
    """Add a row to a ledger, and print it."""
    with ledger.open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(row) + "\n")
    print(json.dumps(row), flush=True)


def row_of(case: Case, strategy: str, seed: int) -> dict[str, Any]:
    """Run one case by one strategy; return what the ledger keeps."""
    began, cpu = time.perf_counter(), time.process_time()
    made: dict[str, Callable[[Case, int], dict[str, Any]]] = {"hunt": by_hunt, "random": at_random, "full": full}
    try:
        found = made[strategy](case, seed)
    except HjcampError as problem:
        found = {"verdict": f"failed: {problem}"[:200], "effects": [], "rig_s": 0.0, "tests": 0}
    word, names = case.right
    verdict = (found["verdict"], sorted(found["effects"]))
    named = set(found["effects"]) if found["verdict"] == "effect" else set()
    judged = {"right": verdict == (word, sorted(names)), "false_name": bool(named - set(names))}
    times = {"wall_s": round(time.perf_counter() - began, 1), "cpu_s": round(time.process_time() - cpu, 1)}
    return {"case": case.name, "strategy": strategy, "seed": seed, **found, **judged, **times, "code": git_label()[:8]}


def lines_of(case: Case, seed: int, condition: tuple[str, ...]) -> list[str]:
    """Return the overrides of one condition of a case, with what is hidden."""
    lines = [f"plant={case.rig.name}", *case.rig.lines, *condition]
    if not case.hidden:
        return lines
    config = Composer().compose([free(line) for line in lines]).config
    _, hidden = hidden_config(config, [case.hidden], seed)
    values = [f"effects.{name}.{key}={value:.6g}" for name, each in hidden.items() for key, value in each.items()]
    return [*lines, *values]


def asked_of(case: Case, seed: int) -> Asked:
    """Return how a case is diagnosed."""
    return Asked(effort=EFFORT, seed=1, without=case.hidden if case.outside else None, workers=WORKERS)


def by_hunt(case: Case, seed: int) -> dict[str, Any]:
    """Hunt with the rig time of the full campaign as the budget: a hunt that takes longer is worth nothing."""
    lines = [*lines_of(case, seed, case.rig.conditions[0]), f"repetitions={REPETITIONS_OF_A_HUNT}", f"seed={seed}", "workers=1"]
    without = ["--without", case.hidden] if case.outside else []
    budget = f"{full_seconds(case, seed):.3f}s"
    words = [
        "hunt",
        *lines,
        "run_dir=hunt",
        "--budget",
        budget,
        "--effort",
        EFFORT,
        "--workers",
        str(WORKERS),
        "--tests",
        "2",
        *without,
    ]
    if (code := cli.run(words)) != 0:
        raise HjcampError(f"hjcamp hunt ended with {code}")
    found = json.loads(Path("hunt/hunt.json").read_text(encoding="utf-8"))
    keys = ("verdict", "effects", "reason", "not_ruled_out")
    counts = [len(one["tests"]) * one["repetitions"] for one in found["rounds"] if one["made"]]
    return {**{key: found[key] for key in keys}, "rig_s": found["spent_s"], "rounds": len(counts), "tests": sum(counts)}


def at_random(case: Case, seed: int) -> dict[str, Any]:
    """Make as many tests as the hunt did, at random from those that it could have chosen."""
    from hjcamp.commands.hunting.any_plant import Makeable, course_config, motion_config
    from hjcamp.commands.hunting.chosen import condition_name, plan_of
    from hjcamp.commands.hunting.limits import beyond_limits
    from hjcamp.diagnosis.design.menu import menu
    from hjcamp.diagnosis.design.truth import held_by_loop

    rounds = json.loads(Path("hunt/hunt.json").read_text(encoding="utf-8"))["rounds"]
    wanted = sum(len(one["tests"]) for one in rounds[1:] if one["made"])
    runs = [Path("hunt/00_campaign")]
    if wanted:
        first = json.loads(Path("hunt/plan_00.json").read_text(encoding="utf-8"))
        config = first["conditions"][0]["config"]
        done = diagnose_plant(Data(runs), asked_of(case, seed))
        by_motion, able = held_by_loop(done.analysis), Makeable(done, [config])
        measured = done.analysis.measured
        samples = int(np.median([test.samples for test in measured.tests]))
        tests = [one for one in menu(measured, samples, by_motion) if able(one, by_motion)]
        order = np.random.default_rng(seed).permutation(len(tests))
        models = [done.analysis.base.fitted.candidate]
        configs: dict[str, dict[str, Any]] = {}
        for place in order:
            one = tests[place]
            made = motion_config(config, done, one) if by_motion else course_config(config, _Begun(done), _As(one))
            if not beyond_limits(made, models):
                configs[condition_name(one.name, 1, configs)] = made
            if len(configs) == wanted:
                break
        plan = plan_of("random", "", configs, REPETITIONS_OF_A_HUNT, seed)
        make_run(plan, Composer().compose([]).config, [], make_console(), Path("random"))
        runs.append(Path("random"))
    return concluded(runs, case, seed)


class _As:
    """A test of the menu as `course_config` takes one that was proposed."""

    def __init__(self, wanted: Any) -> None:
        self.wanted, self.place = wanted, 0


class _Begun:
    """An analysis as `course_config` takes a proposal: where the measured tests begin."""

    def __init__(self, done: Any) -> None:
        from hjcamp.diagnosis.residuals.windows import Windows

        self.analysis = done.analysis
        windows: Windows = done.analysis.windows
        self.proposal = type("Truths", (), {"truths": ((windows,),)})()


def full_seconds(case: Case, seed: int) -> float:
    """Return the rig time of the full campaign, s; it is made where that was not done."""
    return sum(made_seconds(run) for run in full_runs(case, seed))


def full_runs(case: Case, seed: int) -> list[Path]:
    """Make the runs of the full campaign that are not there."""
    runs = []
    for number, condition in enumerate(case.rig.conditions):
        run = Path(f"full_{number}")
        lines = [
            *lines_of(case, seed, condition),
            f"repetitions={REPETITIONS}",
            f"seed={seed + 1 + number}",
            f"run_dir={run}",
            "workers=1",
        ]
        if not (run / "report.html").is_file() and (code := cli.run(["run", *lines])) != 0:
            raise HjcampError(f"hjcamp run ended with {code}")
        runs.append(run)
    return runs


def full(case: Case, seed: int) -> dict[str, Any]:
    """Diagnose the full campaign."""
    return concluded(full_runs(case, seed), case, seed)


def concluded(runs: list[Path], case: Case, seed: int) -> dict[str, Any]:
    """Return what a diagnosis of some runs says, and what they took."""
    data = Data(runs)
    content = diagnose_plant(data, replace(asked_of(case, seed)), silent).content
    sets = content.get("confidence_set", [])
    found = {"verdict": content["verdict"], "effects": content["effects"], "not_ruled_out": sets, "tests": len(data.logs)}
    return {**found, "rig_s": sum(made_seconds(run) for run in runs)}
