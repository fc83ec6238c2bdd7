"""Tolerances against the published values."""

from __future__ import annotations

from pathlib import Path

import pytest
from report_samples import make_log, make_logs

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.published.values import measured_indicators
from hjcamp.report.check import check, read_tolerances
from hjcamp.report.runs.varied import indicators_frame
from hjcamp.report.tables.aggregation import against_published
from hjcamp.report.tables.declared import declared_tables


def test_the_measurements_pass_their_own_print() -> None:
    comparison = against_published(measured_indicators(), declared_tables())
    assert check(comparison, "default") == []
    assert check(comparison, {name: {"absolute": 0.1} for name in ("rmse1_deg", "rmse2_deg", "e_max_deg")}) == []


def test_what_is_outside_is_named() -> None:
    comparison = against_published(indicators_frame(make_logs(3)), declared_tables(["table_5_4_1"]))
    (violation,) = check(comparison, {"e_max_deg": {"absolute": 3.6}})
    assert (violation.table, violation.indicator) == ("table_5_4_1", "e_max_deg")
    assert "cycloid_pos ffwd_pid" in violation.cell
    assert "e_max_deg 0.70, published 5.7 (-5.00, -4.6 published std; allowed 3.6 deg)" in str(violation)
    assert check(comparison, {"e_max_deg": {"absolute": 3.6, "published_std": 5.0}}) == []
    assert len(check(comparison, {"e_max_deg": {"absolute": 0.0}})) == 4


def test_nothing_to_compare_does_not_pass() -> None:
    other = indicators_frame([make_log("ramp_pos", controller="mine")])
    with pytest.raises(UsageError, match="nothing to check"):
        check(against_published(other, declared_tables()))
    comparison = against_published(indicators_frame(make_logs(2)), declared_tables(["table_5_4_1"]))
    with pytest.raises(UsageError, match="nothing to check"):
        check(comparison, {"sse_deg": {"absolute": 1.0}})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "are needed"),
        ("rmse1: {absolute: 1}", "did you mean 'rmse1_deg'"),
        ("rmse1_deg: 1", "needs absolute or published_std"),
        ("rmse1_deg: {absolut: 1}", "did you mean 'absolute'"),
        ("rmse1_deg: {absolute: -1}", "finite number"),
        ("rmse1_deg: {absolute: .nan}", "finite number"),
        ("rmse1_deg: {absolute: true}", "finite number"),
        ("a: [", "tolerances"),
    ],
)
def test_bad_tolerances_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "tolerances.yaml"
    path.write_text(text)
    with pytest.raises(UsageError, match=message):
        read_tolerances(path)


def test_a_missing_file_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="or 'default' is needed"):
        read_tolerances(tmp_path / "none.yaml")
