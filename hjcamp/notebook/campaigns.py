"""Runs in Python: planned, made, found, reported."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError, counted, shown, unknown
from hjcamp.notebook.data import Data, load
from hjcamp.notebook.result import Picture, Result, frame_of, quiet

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.records.plan import Plan as Planned

CONDITIONS = ("condition", "repetitions", "duration_s")
SIMULATION = "simulation"


@dataclass(frozen=True, repr=False)
class Plan(Result):
    """What a run would do. ``frame``: its conditions; ``answer``: the whole plan, with the configuration of each."""

    plan: Planned
    answer: dict[str, Any]

    @property
    def title(self) -> str:
        """How many tests of how long."""
        plan = self.plan
        size = f"{counted(len(plan.conditions), 'condition')} x {counted(plan.repetitions, 'repetition')}"
        return f"{plan.campaign}: {size} = {counted(len(plan.tests), 'test')}, {plan.duration:.0f} s of motion"

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each condition: repetitions and duration of one test (s)."""
        rows = [
            {"condition": one.name, "repetitions": self.plan.repetitions, "duration_s": one.duration}
            for one in self.plan.conditions
        ]
        return frame_of(rows, CONDITIONS)


@dataclass(frozen=True, repr=False)
class Run(Result):
    """A run that was made. ``frame``: the indicators, a row for each test (deg, MPa, s); ``data``: its logs."""

    path: Path
    #: The page of the report.
    page: Path
    indicators: pl.DataFrame
    #: The published tables that were filled, by name, and each published value beside its mean.
    tables: Mapping[str, pl.DataFrame]
    comparison: pl.DataFrame
    #: What was noted of tests, and of how many.
    warnings: Mapping[str, int]

    @property
    def answer(self) -> Mapping[str, Any]:  # type: ignore[override]
        """The rows of the frame."""
        return {"run": str(self.path), "tests": self.frame.to_dicts()}

    @property
    def title(self) -> str:
        """Where it is and how many tests it has."""
        return f"{self.path}: {counted(self.frame.height, 'test')}"

    def sentences(self) -> list[str]:
        """Return what was noted, and where the page is."""
        return [*(f"{text} ({counted(count, 'test')})" for text, count in self.warnings.items()), f"report: {self.page}"]

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each test: condition, choices, indicators, seed, log, what varied."""
        from hjcamp.report.runs.indicators import STANDING

        return self.indicators.drop(STANDING, strict=False)

    @cached_property
    def data(self) -> Data:
        """The logs of the run."""
        return load(self.path)

    def plot(self, indicator: str = "rmse1_deg") -> Picture:
        """Return an indicator of every test by condition."""
        from hjcamp.report.pictures.conditions import BLUE
        from hjcamp.report.pictures.drawing import dress

        numbers = [name for name, kind in self.frame.schema.items() if kind.is_float()]
        if indicator not in numbers:
            raise unknown("indicator", indicator, numbers)
        names = list(dict.fromkeys(self.frame["condition"].to_list()))
        figure = Picture(figsize=(7.4, 1.0 + 0.3 * len(names)), layout="constrained")
        axis = figure.subplots()
        rows = [
            (names.index(one), value) for one, value in self.frame.select("condition", indicator).rows() if value is not None
        ]
        axis.plot([value for _, value in rows], [place for place, _ in rows], "o", color=BLUE, markersize=4, alpha=0.6)
        axis.set_yticks(range(len(names)), names, fontsize=8)
        axis.invert_yaxis()
        axis.set_xlim(left=min(0.0, *(value for _, value in rows)) if rows else 0.0)
        dress(axis, "")
        axis.set_xlabel(indicator, fontsize=8.5)
        return figure


@dataclass(frozen=True, repr=False)
class Runs(Result):
    """Runs that were found, newest first. ``frame``: a row for each."""

    table: pl.DataFrame

    @property
    def answer(self) -> Mapping[str, Any]:  # type: ignore[override]
        """The rows of the frame."""
        return {"runs": self.frame.to_dicts()}

    @property
    def title(self) -> str:
        """How many."""
        return counted(self.frame.height, "run")

    @property
    def frame(self) -> pl.DataFrame:
        """One row for each run."""
        return self.table


def simulate(*overrides: str, **keys: Any) -> Run:
    """Simulate a campaign or one condition, with tables and report, and return the run; `hjcamp run` on the simulation.

    Overrides are those of the command line; a key without dots may be given by name. Raises ``UsageError`` for what cannot be
    run and for a backend that moves a rig, ``HjcampError`` where tests fail.

    >>> made = hjcamp.simulate("plant=stage", "trajectory=ramp", "trajectory.amplitude_v=2", repetitions=1)
    >>> made.frame.height
    1
    >>> made.data.samples(0).height > 100
    True
    """
    return _made(overrides, keys, only_simulation=True)


def run(*overrides: str, live: bool | int = False, **keys: Any) -> Run:
    """Run a campaign or one condition on any backend, a rig too, and return the run; `hjcamp run`.

    ``live``: open a page that follows it, on this port or, with True, on one that is free.

    >>> hjcamp.run("campaign=robustness_vertical", repetitions=0)
    Traceback (most recent call last):
        ...
    hjcamp.errors.UsageError: repetitions is 0; a whole number from 1 to ... is needed
    """
    with _followed(live):
        return _made(overrides, keys, only_simulation=False)


def plan(*overrides: str, **keys: Any) -> Plan:
    """Return what `run` would do with these overrides; nothing is run or written; `hjcamp plan`.

    >>> planned = hjcamp.plan("campaign=robustness_vertical", repetitions=3)
    >>> planned.frame.height, len(planned.plan.tests)
    (8, 24)
    """
    made = _planned(_lines(overrides, keys))[0]
    return Plan(made, made.as_json())


def resume(path: str | Path, live: bool | int = False) -> Run:
    """Go on with a run that was stopped and return it, with a page as `run` opens it; `hjcamp resume`.

    >>> hjcamp.resume("logs")
    Traceback (most recent call last):
        ...
    hjcamp.errors.UsageError: logs is not a run folder: plan.json is missing
    """
    from hjcamp.campaign.files.run_folder import open_folder
    from hjcamp.campaign.one_run import finish_run

    folder = open_folder(Path(path))
    with _followed(live):
        return _of(finish_run(folder, quiet()))


def report(path: str | Path, against: str | None = "published") -> Run:
    """Make tables and page of a run folder or a folder of logs again, and return them; `hjcamp report`.

    >>> hjcamp.report("nowhere")
    Traceback (most recent call last):
        ...
    hjcamp.errors.UsageError: nowhere: there is no such file or folder
    """
    from hjcamp.campaign.further_pictures import further_pictures
    from hjcamp.report.build import build_report

    made = build_report(Path(path), against=against, further=further_pictures)
    return Run(made.run_dir, made.page, made.indicators, made.tables, made.comparison, {})


def runs(*filters: str, columns: Sequence[str] = (), folder: str | Path | None = None) -> Runs:
    """Return the runs that meet every KEY=VALUE, newest first, with further ``columns``; `hjcamp ls`.

    >>> hjcamp.runs("campaign=none_of_this_name").frame.height
    0
    """
    from hjcamp.campaign.runs.finding import FOLDERS, find_runs
    from hjcamp.campaign.runs.listing import USUAL, rows_of

    shown = list(dict.fromkeys([*USUAL, *columns]))
    found = find_runs([Path(folder)] if folder else FOLDERS, filters)
    return Runs(frame_of(rows_of(found, shown), shown))


def _lines(overrides: Sequence[str], keys: Mapping[str, Any]) -> list[str]:
    from hjcamp.configuration.composer import as_override

    return [*overrides, *(as_override(key, value) for key, value in keys.items())]


def _planned(lines: Sequence[str]) -> tuple[Planned, dict[str, Any]]:
    from hjcamp.campaign.plan.planning import composed_plan
    from hjcamp.configuration.composer import Composer
    from hjcamp.configuration.overrides import parse_overrides

    for one in parse_overrides(lines):
        if one.is_sweep_override():
            raise UsageError(f"'{one.input_line}' is a sweep: make one run for each value, or call hjcamp run -m")
    return composed_plan(lines, Composer())


def _made(overrides: Sequence[str], keys: Mapping[str, Any], only_simulation: bool) -> Run:
    from hjcamp.campaign.one_run import make_run
    from hjcamp.configuration.composer import free

    lines = _lines(overrides, keys)
    planned, asked = _planned(lines)
    others = {str(one.config["backend"].get("name")) for one in planned.conditions} - {SIMULATION}
    if only_simulation and others:
        raise UsageError(f"backend={', '.join(sorted(others))} is no simulation; hjcamp.run(...) takes every backend")
    return _of(make_run(planned, asked, [free(line) for line in lines], quiet()))


def _followed(live: bool | int) -> AbstractContextManager[None]:
    from hjcamp.live.process import HIGHEST_PORT, LiveAsk, live_page

    if live is False:
        return nullcontext()
    if not isinstance(live, int) or not 0 < live <= HIGHEST_PORT:
        raise UsageError(f"live is {shown(live)}; True, False or a port from 1 to {HIGHEST_PORT} is needed")
    return live_page(LiveAsk(0 if live is True else live), print)


def _of(made: Any) -> Run:
    from hjcamp.campaign.conclude import grouped

    found = made.report
    return Run(made.path, found.page, found.indicators, found.tables, found.comparison, dict(grouped(made.result.warnings)))
