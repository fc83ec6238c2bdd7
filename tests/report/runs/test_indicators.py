"""The indicators by their definitions in thesis 5.2.5."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from report_samples import make_log

from hjcamp.records.log import TestLog
from hjcamp.report.runs.indicators import COLUMNS, FURTHER, STANDING, indicators_of
from hjcamp.report.runs.varied import indicators_frame


def with_error(log: TestLog, error: np.ndarray) -> TestLog:
    columns = dict(log.columns)
    command = columns["phase"] == 3.0
    arm = columns["arm_deg"].copy()
    arm[command] = columns["reference_deg"][command] - error
    return dataclasses.replace(log, columns=columns | {"arm_deg": arm})


def test_a_constant_error_is_every_indicator() -> None:
    row = indicators_of(make_log("cycloid_pos", error_deg=-0.4, repetition=2))
    assert row["rmse1_deg"] == pytest.approx(0.2)
    assert row["rmse2_deg"] == pytest.approx(0.2)
    assert row["e_max_deg"] == pytest.approx(0.2)
    assert row["sse_deg"] == pytest.approx(-0.2)  # desired - output: negative where the arm is beyond
    assert row["repetition"] == 2


def test_the_first_quarter_second_is_left_out_of_rmse2() -> None:
    error = np.zeros(1000)
    error[:250] = 4.0
    row = indicators_of(with_error(make_log("ramp_pos"), error))
    assert row["rmse1_deg"] == pytest.approx(2.0)
    assert row["rmse2_deg"] == 0.0
    assert row["e_max_deg"] == 4.0
    assert row["sse_deg"] is None
    error[250] = 1.0
    assert indicators_of(with_error(make_log("ramp_pos"), error))["rmse2_deg"] == pytest.approx(np.sqrt(1.0 / 750))


@pytest.mark.parametrize("trajectory", ["cycloid_pos", "cycloid_neg"])
def test_steady_state_begins_200_ms_after_the_cycloid(trajectory: str) -> None:
    time = np.arange(2000) / 1000.0
    before = np.where(time < 1.2 - 1e-9, 9.0, 0.3)
    assert indicators_of(with_error(make_log(trajectory), before))["sse_deg"] == pytest.approx(0.3)
    later = np.where(time < 1.205, 9.0, 0.3)
    assert indicators_of(with_error(make_log(trajectory), later))["sse_deg"] > 0.3


def test_only_cycloids_have_a_steady_state_error() -> None:
    assert indicators_of(make_log("ramp_pos"))["sse_deg"] is None
    assert indicators_of(make_log("sine_0p5hz"))["sse_deg"] is None


def test_what_a_log_cannot_give_is_null() -> None:
    log = make_log("cycloid_pos")
    without = {name: values for name, values in log.columns.items() if name != "reference_deg"}
    row = indicators_of(TestLog(columns=without, metadata={"repetition": "first"}))
    assert [row[name] for name in ("rmse1_deg", "rmse2_deg", "e_max_deg", "sse_deg")] == [None] * 4
    assert row["repetition"] is None
    assert row["controller"] is None


def test_friction_comes_from_the_attached_configuration() -> None:
    log = make_log("ramp_pos")
    metadata = {name: text for name, text in log.metadata.items() if name != "friction"}
    config = b"friction: {name: reduced}\ntubing: hdpe_300mm\n"
    attached = dataclasses.replace(log, metadata=metadata, attachments={"config.yaml": config})
    assert indicators_of(attached)["friction"] == "reduced"
    assert indicators_of(attached)["tubing"] == "ldpe_300mm"  # the metadata come first
    damaged = dataclasses.replace(log, metadata=metadata, attachments={"config.yaml": b"{: \xff"})
    assert indicators_of(damaged)["friction"] is None


def test_a_log_without_phases_counts_whole() -> None:
    log = make_log("ramp_pos")
    columns = {name: values[log.columns["time_s"] >= 0] for name, values in log.columns.items() if name != "phase"}
    assert indicators_of(dataclasses.replace(log, columns=columns)) == indicators_of(log)


def test_the_frame_has_the_columns_of_the_contract() -> None:
    frame = indicators_frame([make_log("ramp_pos"), make_log("cycloid_pos")])
    assert tuple(frame.columns) == ("condition", *COLUMNS, "seed", "log", *FURTHER, STANDING)
    assert tuple(indicators_frame([]).columns) == tuple(frame.columns)
    assert frame["sse_deg"].null_count() == 1
