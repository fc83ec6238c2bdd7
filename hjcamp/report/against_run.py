"""A run next to another run: means of the same conditions, their differences, and which of them are more than scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import polars as pl

from hjcamp.errors import UsageError, counted, nearest
from hjcamp.records.plan import lasting_name
from hjcamp.report.runs.indicators import INDICATORS, configuration, row_of
from hjcamp.report.runs.origin import read_origin
from hjcamp.report.runs.settings import difference
from hjcamp.report.runs.varied import frame_with_varied
from hjcamp.report.tables.aggregation import by_condition
from hjcamp.report.tables.welch import SIGNIFICANT, Sample, holm, welch

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

DECIMALS = 2
SHOWN = 3
COLUMNS: dict[str, Any] = {
    "table": pl.String, "condition": pl.String, "indicator": pl.String, "n": pl.Int64, "mean": pl.Float64, "std": pl.Float64,
    "baseline_n": pl.Int64, "baseline_mean": pl.Float64, "baseline_std": pl.Float64, "difference": pl.Float64,
    "difference_in_std": pl.Float64, "p": pl.Float64, "p_holm": pl.Float64,
}  # fmt: skip


@dataclass(frozen=True)
class Tests:
    """The tests of one run: its name, their indicators, the configuration of each condition, what the logs say."""

    name: str
    indicators: pl.DataFrame
    configurations: Mapping[str, Mapping[str, Any]]
    metadata: Sequence[dict[str, str]] = ()

    @cached_property
    def conditions(self) -> list[str]:
        """The names of the conditions, each once; `UsageError` where one name stands for two configurations."""
        names = by_condition(self.indicators, None)["condition"].to_list()
        for name in names:
            if names.count(name) > 1:
                raise UsageError(f"{self.name}: '{name}' names several conditions; compare one run with one other")
        return names

    def samples(self, indicator: str) -> dict[str, Sample]:
        """Return mean, deviation and n of an indicator by condition, where it is defined."""
        rows = by_condition(self.indicators, None).iter_rows(named=True)
        counts = dict(self.indicators.group_by("condition").agg(pl.col(indicator).count()).iter_rows())
        return {
            row["condition"]: Sample(row[f"{indicator}_mean"], row[f"{indicator}_std"], counts[row["condition"]])
            for row in rows
            if row[f"{indicator}_mean"] is not None
        }


def tests_of(name: str, indicators: pl.DataFrame, logs: Sequence[TestLog]) -> Tests:
    """Return the tests of ``logs`` with their ``indicators``."""
    attached = {log.condition_key: log.attachments.get("config.yaml", b"") for log in logs}
    configurations = {key: configuration(text) for key, text in attached.items()}
    return Tests(name, indicators, configurations, [log.metadata for log in logs])


def read_tests(path: Path) -> Tests:
    """Return the tests of a run folder or a folder of logs, read one after the other; `UsageError` as a report has it."""
    from hjcamp.records.find import refuse_mixed_plants
    from hjcamp.records.stored import stored_logs

    logs = stored_logs([path])
    refuse_mixed_plants(logs)
    rows = [row_of(log, path) for log in logs]
    attached = [log.attachments.get("config.yaml", b"") for log in logs]
    return tests_of(str(path), frame_with_varied(rows, attached, read_origin(path).axes), logs)


@dataclass(frozen=True)
class RunComparison:
    """``run`` next to ``baseline``: condition by condition of equal name, or the only one of each."""

    run: Tests
    baseline: Tests

    @cached_property
    def pairs(self) -> dict[str, str]:
        """The conditions of the run, each with the one of the baseline that it is compared with."""
        ours, theirs = self.run.conditions, self.baseline.conditions
        if len(ours) == len(theirs) == 1:
            return {ours[0]: theirs[0]}
        there = {lasting_name(name): name for name in theirs}
        return {name: there[lasting_name(name)] for name in ours if lasting_name(name) in there}

    def refuse_without_pairs(self) -> None:
        """Raise `UsageError` where the runs have no condition in common."""
        if self.pairs:
            return
        ours, theirs = self.run.conditions, self.baseline.conditions
        similar = next(((one, match) for one in ours if (match := nearest(one, theirs))), None)
        hint = f"; '{similar[0]}' is nearest to '{similar[1]}'" if similar else ""
        raise UsageError(
            f"{self.run.name} and {self.baseline.name} have no condition in common: {_some(ours)} here, {_some(theirs)} "
            f"there{hint}. A baseline has conditions of the same names"
        )

    @cached_property
    def cells(self) -> pl.DataFrame:
        """One row for each indicator of each pair; ``p_holm`` is corrected for the number of rows (`COLUMNS`)."""
        rows = []
        for indicator in INDICATORS:
            ours, theirs = self.run.samples(indicator), self.baseline.samples(indicator)
            for name, other in self.pairs.items():
                if name in ours and other in theirs:
                    rows.append(_row(name, indicator, ours[name], theirs[other]))
        for row, corrected in zip(rows, holm([row["p"] for row in rows]), strict=True):
            row["p_holm"] = corrected
        order = {name: place for place, name in enumerate(self.pairs)}
        rows.sort(key=lambda row: order[row["condition"]])
        return pl.DataFrame(rows, schema=COLUMNS)

    def with_reference(self, table: pl.DataFrame, names: Sequence[str], magnitudes: Sequence[str] = ()) -> pl.DataFrame:
        """Return an aggregated table with ``<indicator>_baseline_mean``, ``_std``, ``_n``, ``_difference`` and ``_p``."""
        found = {(row["condition"], row["indicator"]): row for row in self.cells.iter_rows(named=True)}
        by = table["condition" if "condition" in table.columns else "_condition"].to_list()
        for name in names:
            rows = [found.get((condition, name), {}) for condition in by]
            parts = {
                "baseline_mean": "baseline_mean",
                "baseline_std": "baseline_std",
                "difference": "difference",
                "p": "p_holm",
            }
            table = table.with_columns(
                *(pl.Series(f"{name}_{new}", [row.get(old) for row in rows], pl.Float64) for new, old in parts.items()),
                pl.Series(f"{name}_baseline_n", [row.get("baseline_n") for row in rows], pl.Int64),
                pl.Series(f"{name}_decimals", [DECIMALS] * len(rows), pl.Int64),
                pl.Series(f"{name}_printed", [bool(row) for row in rows], pl.Boolean),
            )
            if name in magnitudes:
                magnitude = pl.col(f"{name}_mean").abs() - pl.col(f"{name}_baseline_mean").abs()
                table = table.with_columns(magnitude.alias(f"{name}_difference"))
        return table

    @property
    def changes(self) -> dict[str, list[str]]:
        """Where the configuration differs, in words, each with its conditions."""
        found: dict[str, list[str]] = {}
        for name, other in self.pairs.items():
            for text in difference(self.run.configurations.get(name, {}), self.baseline.configurations.get(other, {})):
                found.setdefault(text, []).append(name)
        return found

    @property
    def notes(self) -> list[str]:
        """What a reader of the comparison has to know."""
        ours, theirs = self.run.conditions, self.baseline.conditions
        notes = [
            f"Baseline: {self.baseline.name}. ▲ ▼: the means differ, Welch's t test, p < {SIGNIFICANT:g} after Holm's "
            f"correction for {counted(self.cells['p'].count(), 'test')}."
        ]
        notes += [f"{_of(names, len(self.pairs))}{text}." for text, names in list(self.changes.items())[: 2 * SHOWN]]
        if len(self.changes) > 2 * SHOWN:
            notes.append(f"{len(self.changes) - 2 * SHOWN} more differences of the configuration: hjcamp diff.")
        if len(ours) > len(self.pairs):
            notes.append(f"Without a baseline: {_some([name for name in ours if name not in self.pairs])}.")
        left = [name for name in theirs if name not in self.pairs.values()]
        if left:
            notes.append(f"In the baseline alone: {_some(left)}.")
        if self._same_draws():
            notes.append("Tests of equal number share their seed; the test takes them as independent, which is cautious.")
        return notes

    @property
    def verdict(self) -> str:
        """How many means differ, in one sentence."""
        known = self.cells.drop_nulls("p_holm")
        differing = known.filter(pl.col("p_holm") < SIGNIFICANT).height
        unknown = self.cells.height - known.height
        said = (
            f"{differing} of {known.height} means differ from those of {self.baseline.name} (p < {SIGNIFICANT:g}, Welch, Holm)"
        )
        return said + (f"; {unknown} cannot be judged: fewer than two tests." if unknown else ".")

    def _same_draws(self) -> bool:
        columns = ["condition", "repetition", "seed"]
        both = self.run.indicators.select(columns).join(self.baseline.indicators.select(columns), on=columns)
        return both.drop_nulls("seed").height > 0


def _row(condition: str, indicator: str, ours: Sample, theirs: Sample) -> dict[str, Any]:
    change = ours.mean - theirs.mean
    return {
        "table": "conditions", "condition": condition, "indicator": indicator, "n": ours.n, "mean": ours.mean, "std": ours.std,
        "baseline_n": theirs.n, "baseline_mean": theirs.mean, "baseline_std": theirs.std, "difference": change,
        "difference_in_std": change / theirs.std if theirs.std else None, "p": welch(ours, theirs),
    }  # fmt: skip


def _some(names: Sequence[str]) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"{', '.join(names[:SHOWN])}{more}"


def _of(names: Sequence[str], pairs: int) -> str:
    return "" if len(names) == pairs else f"{_some(names)}: "
