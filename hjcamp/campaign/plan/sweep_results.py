"""What came out of a sweep: the objectives of its jobs with what was varied, the best, and what to do next."""

from __future__ import annotations

import csv
import io
import shlex
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from hjcamp.campaign.plan.objective import Objective, read_objectives
from hjcamp.errors import HjcampError
from hjcamp.report.tables.formats import escape_csv
from hjcamp.storage import write_whole
from hjcamp.yaml_file import read_yaml

MAXIMIZE = "maximize"
#: What belongs to the sweep, not to the run that it leads to.
OF_THE_SWEEP = ("objective", "run_dir", "seed")
SHOWN = 5


@dataclass(frozen=True)
class JobResult:
    """A job that has a report: its run folder, its overrides by key, the values of the objectives."""

    path: Path
    overrides: dict[str, str]
    values: tuple[float, ...]


@dataclass(frozen=True)
class SweepResult:
    """The jobs of a sweep, in their order, and what each objective is wanted to be."""

    folder: Path
    objectives: tuple[Objective, ...]
    directions: tuple[str, ...]
    varied: tuple[str, ...]
    jobs: tuple[JobResult, ...]

    @property
    def best(self) -> list[JobResult]:
        """The jobs than which no other is better in every objective; the first objective decides the order."""
        signs = [-1.0 if way == MAXIMIZE else 1.0 for way in self.directions]
        seen = [(job, tuple(sign * value for sign, value in zip(signs, job.values, strict=True))) for job in self.jobs]
        front = [
            (job, own)
            for job, own in seen
            if not any(all(a <= b for a, b in zip(other, own, strict=True)) and other != own for _, other in seen)
        ]
        return [job for job, _ in sorted(front, key=lambda one: one[1])]

    def table(self) -> tuple[list[str], list[list[Any]]]:
        """Return heading and rows: job, what was varied, objectives."""
        head = ["job", *self.varied, *(one.text for one in self.objectives)]
        rows = [[one.path.name, *(one.overrides.get(key, "") for key in self.varied), *one.values] for one in self.jobs]
        return head, rows

    def write(self) -> Path:
        """Write the table as ``sweep.csv`` into the folder of the sweep."""
        stream = io.StringIO()
        head, rows = self.table()
        csv.writer(stream, lineterminator="\n").writerows(
            [escape_csv(cell) if isinstance(cell, str) else cell for cell in row] for row in (head, *rows)
        )
        write_whole(self.folder / "sweep.csv", stream.getvalue())
        return self.folder / "sweep.csv"

    def next_command(self) -> str:
        """Return the run of the best job with other draws: the best of many is also the luckiest."""
        best = self.best[0]
        seed = best.overrides.get("seed", "1")
        lines = [f"{key}={value}" for key, value in best.overrides.items() if key not in OF_THE_SWEEP]
        again = f"seed={int(seed) + 1}" if seed.isdecimal() else "seed=2"
        return shlex.join(["hjcamp", "run", *lines, again])


def read_results(folder: Path, directions: Sequence[str], fixed: Collection[str]) -> SweepResult | None:
    """Return what is in the folder of a sweep; None where no job has an objective. ``fixed`` are keys that were not varied."""
    found: list[JobResult] = []
    objectives: tuple[Objective, ...] = ()
    plans = folder.glob("*/plan.json")
    for path in sorted((one.parent for one in plans), key=lambda one: (len(one.name), one.name)):
        content = read_yaml(path / "config.yaml")
        objectives = read_objectives(content.get("objective"))
        table = path / "tables" / "indicators.parquet"
        if not objectives or not table.is_file():
            continue
        try:
            values = tuple(one.of(pl.read_parquet(table)) for one in objectives)
        except HjcampError:
            # The job itself has said why.
            continue
        lines = [str(line).partition("=") for line in content["overrides"]]
        found.append(JobResult(path, {key.lstrip("+"): value for key, _, value in lines}, values))
    if not found:
        return None
    keys = dict.fromkeys(key for one in found for key in one.overrides)
    varied = tuple(key for key in keys if key not in fixed)
    wanted = tuple(directions) if len(directions) == len(objectives) else ("minimize",) * len(objectives)
    return SweepResult(folder, objectives, wanted, varied, tuple(found))
