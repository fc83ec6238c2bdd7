"""Measured tests in Python: loaded, imported, looked at."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from hjcamp import analyses
from hjcamp.analyses.data import Data as Read
from hjcamp.errors import UsageError, counted, unknown
from hjcamp.notebook.result import Picture, Result, frame_of

if TYPE_CHECKING:
    import polars as pl

    from hjcamp.records.log import TestLog

COLUMNS = ("test", "condition", "repetition", "samples", "duration_s", "log")
SIZE = (9.6, 2.2)


class Data(Read, Result):
    """Measured tests: ``logs``, ``plant``, ``frame`` (a row for each test), ``samples`` and ``plot`` of one of them.

    ``data[0]`` is the first test, ``data[1:]`` all but it, ``data["sine*"]`` those of the conditions (or test names) of a pattern, each
    again such data; ``for test in data`` goes through the tests one by one.
    """

    @property
    def title(self) -> str:
        """How many tests of which plant."""
        conditions = len({log.condition_key for log in self.logs})
        return f"{counted(len(self.logs), 'test')}, {counted(conditions, 'condition')}, plant {self.plant_name}"

    @property
    def answer(self) -> Mapping[str, Any]:  # type: ignore[override]
        """The rows of the frame."""
        return {"plant": self.plant_name, "tests": self.frame.to_dicts()}

    @cached_property
    def frame(self) -> pl.DataFrame:
        """One row for each test: its name, condition, repetition, samples, duration (s), file."""
        repetitions: dict[str, Any] = {name: log.metadata.get("repetition") for name, log in self._named.items()}
        if all(one is None or one.isdecimal() for one in repetitions.values()):
            repetitions = {name: None if one is None else int(one) for name, one in repetitions.items()}
        rows = [
            {
                "test": name,
                "condition": log.condition_key,
                "repetition": repetitions[name],
                "samples": log.samples,
                "duration_s": log.duration,
                "log": str(log.path),
            }
            for name, log in self._named.items()
        ]
        return frame_of(rows, COLUMNS)

    @cached_property
    def indicators(self) -> pl.DataFrame:
        """One row for each test that follows a reference: RMSE1, RMSE2, largest and steady state error (deg), lines, what varied."""
        from hjcamp.report.runs.indicators import STANDING
        from hjcamp.report.runs.varied import indicators_frame

        return indicators_frame(self.logs).drop(STANDING)

    def samples(self, test: str | int = 0, *, condition: str | None = None) -> pl.DataFrame:
        """Return the samples of one test, by name or place: time (s) and every field, in the units of their names.

        With a ``condition`` (its name or a pattern, ``"*"`` for all) those of all its tests, one below the other, with the columns
        test, condition and repetition in front; a field that a test does not have is null there. ``UsageError`` for one without tests.

        >>> data.samples(condition="*").columns
        ['test', 'condition', 'repetition', 'time_s', 'position_m', 'voltage_v']
        """
        import polars as pl

        if condition is None:
            return pl.DataFrame(self._log(test)[1].columns)
        of_condition = set(self._places(condition, [one.condition_key for one in self.logs]))
        if not of_condition:
            raise unknown("condition", condition, dict.fromkeys(self.frame["condition"]))
        rows = [one for place, one in enumerate(self.frame.iter_rows(named=True)) if place in of_condition]
        keys = ("test", "condition", "repetition")
        long = [
            pl.DataFrame(self._named[one["test"]].columns).select(
                *(pl.lit(one[key], dtype=self.frame.schema[key]).alias(key) for key in keys), pl.all()
            )
            for one in rows
        ]
        return pl.concat(long, how="diagonal")

    def plot(self, test: str | int = 0) -> Picture:
        """Return one test over time, a panel for each unit."""
        from hjcamp.report.pictures.conditions import panels_by_unit
        from hjcamp.report.pictures.drawing import dress

        name, log = self._log(test)
        time = log.columns["time_s"]
        panels = panels_by_unit([one for one in log.columns if one not in ("time_s", "phase")])
        figure = Picture(figsize=(SIZE[0], SIZE[1] * max(len(panels), 1)), layout="constrained")
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axis, panel in zip(axes, panels, strict=True):
            for curve in panel.curves:
                style = "--" if curve.dashed else "-"
                axis.plot(time, log.columns[curve.signal], style, color=curve.colour, label=curve.label, linewidth=0.9)
            dress(axis, panel.title)
            axis.legend(fontsize=8, frameon=False)
        figure.suptitle(name, x=0.01, ha="left", fontsize=10)
        axes[-1].set_xlabel("time (s)", fontsize=8.5)
        return figure

    def __len__(self) -> int:
        return len(self.logs)

    def __getitem__(self, chosen: int | slice | str) -> Data:
        """Return some of the tests, by place, or by name or condition, of which either may be a pattern; ``UsageError`` for none.

        >>> [test.title for test in hjcamp.load("logs")]
        ['1 test, 1 condition, plant stage']
        """
        if isinstance(chosen, slice):
            places: Sequence[int] = range(len(self))[chosen]
        elif isinstance(chosen, str):
            names = self._places(chosen, list(self._named))
            places = names or self._places(chosen, [log.condition_key for log in self.logs])
        else:
            places = [list(self._named).index(self._log(chosen)[0])]
        if not places:
            raise unknown("test or condition", str(chosen), [*self._named, *dict.fromkeys(self.frame["condition"])])
        return self._some(places)

    def __iter__(self) -> Iterator[Data]:
        return (self._some([place]) for place in range(len(self)))

    def _some(self, places: Sequence[int]) -> Data:
        """Return the tests at some places as data of their own, under the names that they have here and not read again."""
        logs, names = [self.logs[place] for place in places], list(self._named)
        found = Data([log.path for log in logs if log.path], self.common)
        found.logs, found._named = logs, {names[place]: self.logs[place] for place in places}
        return found

    @staticmethod
    def _places(pattern: str, of: Sequence[str]) -> list[int]:
        return [place for place, one in enumerate(of) if one == pattern or fnmatchcase(one, pattern)]

    @cached_property
    def _named(self) -> dict[str, TestLog]:
        from hjcamp.report.pages.exploration import names_of

        return dict(zip(names_of(self.logs), self.logs, strict=True))

    def _log(self, test: str | int) -> tuple[str, TestLog]:
        names = list(self._named)
        if isinstance(test, int):
            if not -len(names) <= test < len(names):
                raise UsageError(f"test {test}: there are {len(names)}, counted from 0")
            return names[test], self.logs[test]
        if test not in self._named:
            raise unknown("test", test, names)
        return test, self._named[test]


Tests: TypeAlias = Data | str | Path | Sequence[str | Path]


def load(*paths: str | Path) -> Data:
    """Return the tests at some paths: run folders, folders of logs, log files; ``UsageError`` for what cannot be read.

    >>> data = hjcamp.load("logs")
    >>> data.frame.columns
    ['test', 'condition', 'repetition', 'samples', 'duration_s', 'log']
    >>> data.samples(0).columns
    ['time_s', 'position_m', 'voltage_v']
    >>> figure = data.plot(0)
    """
    data = Data([Path(path) for path in paths])
    _ = data.logs  # read now: what is damaged is said here
    return data


def data_of(tests: Tests) -> Data:
    """Return tests as they were loaded; load them where paths are given."""
    if isinstance(tests, Data):
        return tests
    return load(*([tests] if isinstance(tests, str | Path) else tests))


def import_logs(files: str | Path | Sequence[str | Path], map: str | Path, into: str | Path | None = None) -> Data:
    """Make test logs of measurements from elsewhere (CSV, MATLAB, Parquet, MCAP) by a map, and load them; `hjcamp import`.

    >>> hjcamp.import_logs("train.csv", map="map.yaml", into="imported").title
    '1 tests, 1 conditions, plant stage'
    """
    from hjcamp.commands.logs.import_ import targets_of
    from hjcamp.records.elsewhere.importing import import_files

    sources = [Path(one) for one in ([files] if isinstance(files, str | Path) else files)]
    targets = targets_of(sources, None if into is None else Path(into), None)
    import_files(sources, Path(map), targets)
    return load(*targets)


def progress_to(progress: analyses.data.Report | None) -> analyses.data.Report:
    """Return the callback that hears what is done and its share (0 to 1); nobody hears it where None was given."""
    return progress or analyses.data.silent
