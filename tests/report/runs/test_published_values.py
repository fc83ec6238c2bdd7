"""The published values, and the whole pipeline on the 96 x 7 real repetitions."""

from __future__ import annotations

import math
from pathlib import Path

import polars as pl
import pytest

from hjcamp.plants.pump_joint.published import consistency
from hjcamp.plants.pump_joint.published.consistency import HALF_STEP, HALF_STEP_OF_STD, implied_mean, implied_std
from hjcamp.plants.pump_joint.published.values import measured_indicators, printed_rows, published_cells
from hjcamp.report.tables.aggregation import build_table
from hjcamp.report.tables.declared import declared_tables

TABLES = {"5.4.1": "table_5_4_1", "5.4.2": "table_5_4_2", "5.5.1": "table_5_5_1", "5.5.2": "table_5_5_2"}


@pytest.mark.parametrize("printed_table", TABLES)
def test_printed_means_and_deviations_come_out_of_the_repetitions(printed_table: str) -> None:
    (definition,) = declared_tables([TABLES[printed_table]])
    table = build_table(measured_indicators(), definition)
    rows = printed_rows().filter(pl.col("table") == printed_table)
    keys = [name for name in ("trajectory", "controller", "orientation") if name in table.columns]
    checked = 0
    for printed in rows.iter_rows(named=True):
        cell = table.filter(pl.all_horizontal(pl.col(key) == printed[key] for key in keys))
        assert cell.height == 1
        assert cell["n"][0] == 7
        tests = [printed[f"test{number}"] for number in range(1, 8)]
        name = f"{printed['indicator']}_deg"
        # Repetitions are printed to 0.1, so the true mean is within 0.05 of ours, and its print within 0.05 of that.
        assert abs(cell[f"{name}_mean"][0] - printed["mean_printed"]) <= 2 * HALF_STEP + 1e-9
        if printed["std_printed"] is not None:
            low, high = implied_std(tests)
            divided_by_n = cell[f"{name}_std"][0] * math.sqrt(6 / 7)
            assert low <= divided_by_n <= high
            assert low - HALF_STEP_OF_STD - 1e-9 <= printed["std_printed"] <= high + HALF_STEP_OF_STD + 1e-9
            # Rounding moves a deviation of seven values by at most 0.0495, the print by 0.005 more.
            assert abs(divided_by_n - printed["std_printed"]) <= 0.0545
        checked += 1
    assert checked == rows.height > 0


def test_all_measured_cells_are_there() -> None:
    assert printed_rows().height == 96
    assert published_cells().filter(~pl.col("simulated") & (pl.col("table") != "6.3.1")).height == 96
    assert measured_indicators().height == (14 + 14) * 7
    assert published_cells().filter(pl.col("table") == "5.6.1").height == 18
    assert published_cells().filter(pl.col("table") == "6.3.1").height == 14
    duplicates = published_cells().select(pl.exclude("mean", "std", "decimals", "simulated")).is_duplicated()
    assert not duplicates.any()


def test_implied_intervals_hold_every_rounding() -> None:
    tests = [1.0, 1.1, 1.3, 0.9, 1.0, 1.2, 1.4]
    low, high = implied_std(tests, divisor_less=1)
    for sign in range(128):
        moved = [value + (0.05 if sign >> place & 1 else -0.05) for place, value in enumerate(tests)]
        deviation = pl.Series(moved).std()
        assert isinstance(deviation, float)
        assert low - 1e-9 <= deviation <= high + 1e-9
    assert implied_std([1.0] * 7)[0] == 0.0
    assert implied_mean([1.0, 1.2]) == (pytest.approx(1.05), pytest.approx(1.15))


def test_the_printed_deviation_divides_by_n() -> None:
    places = [item.place for item in consistency.print_inconsistencies()]
    assert not [place for place in places if "deviation" in place or "mean" in place]
    assert consistency.sample_deviations_excluded() == 17


def test_the_committed_list_is_the_one_that_is_found() -> None:
    committed = Path(__file__).parents[3] / "docs" / "published_inconsistencies.md"
    assert committed.read_text(encoding="utf-8") == consistency.inconsistencies_text()
    assert len(consistency.print_inconsistencies()) == 3
