"""Indicators of the lines and of the command, the improvement in percent, and the map of a study."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polars as pl
import pytest
from report_samples import make_log

from hjcamp.campaign.further_pictures import map_pictures, varied_numbers
from hjcamp.plants.pump_joint.indicators import FURTHER, line_indicators
from hjcamp.report.pictures.map import draw_map
from hjcamp.report.runs.indicators import indicators_of
from hjcamp.report.tables.declared import Column, TableDefinition
from hjcamp.report.tables.sheet import arrange, arrange_lines


def test_times_beyond_each_bound_and_the_share_of_the_feedforward() -> None:
    log = make_log("cycloid_pos", "ffwd_pid")
    command = log.columns["time_s"] >= 0.0
    one, two = np.full(command.shape, 0.3), np.full(command.shape, 0.3)
    inside = np.flatnonzero(command)
    one[inside[:50]], two[inside[:30]] = 0.6, 0.05
    one[inside[50:60]] = 0.7
    forward = np.where(command, 3.0, 0.0)
    log = replace(log, columns=log.columns | {
        "pressure1_mpa": one, "pressure2_mpa": two, "feedforward_deg": forward, "pid_deg": -forward / 3.0,
    })  # fmt: skip
    found = line_indicators(log, {})
    assert found == pytest.approx(
        {
            "pressure_low_mpa": 0.05,
            "pressure_high_mpa": 0.7,
            "below_0p1_s": 0.030,
            "above_0p58_s": 0.060,
            "above_range_s": 0.010,
            "feedforward_share": 0.75,
        }
    )
    wide = {"rig": {"sensors": {"pressure_range_mpa": 1.0}}}
    assert line_indicators(log, wide)["above_range_s"] == 0.0
    assert {name: indicators_of(log)[name] for name in FURTHER} == pytest.approx(found)


def test_what_a_log_does_not_hold_is_none() -> None:
    log = make_log("ramp_pos")
    bare = {name: log.columns[name] for name in ("time_s", "reference_deg", "arm_deg")}
    assert set(line_indicators(replace(log, columns=bare), {}).values()) == {None}


def test_a_sheet_of_the_lines_shows_what_there_is() -> None:
    frame = pl.DataFrame({"condition": ["a", "b"], "trajectory": ["ramp_pos", "mixed"], "n": [2, 2]})
    for name in ("controller", "payload", "orientation", "pump", "amplifier", "tubing", "friction"):
        frame = frame.with_columns(pl.lit("x").alias(name))
    frame = frame.select("condition", "trajectory", *frame.columns[3:], "n")
    values: dict[str, list[float | None]] = {}
    for name in FURTHER:
        values[f"{name}_mean"] = [0.1, 0.2] if name.startswith("pressure") else [None, None]
        values[f"{name}_std"] = [None, None]
    frame = frame.with_columns(pl.Series(name, value, pl.Float64) for name, value in values.items())
    (sheet,) = arrange_lines(frame.select(*[name for name in frame.columns if name != "n"], "n"))
    assert sheet.headers[-2:] == ["lowest, MPa", "highest, MPa"]
    assert arrange_lines(frame.with_columns(pl.lit(None, pl.Float64).alias(f"{name}_mean") for name in FURTHER)) == []


def test_the_improvement_stands_behind_the_value() -> None:
    columns = [Column("before", {"friction": "unidirectional"}), Column("after", {"friction": "reduced"})]
    definition = TableDefinition(
        name="t", title="t", indicators=["e_max_deg"], by={"trajectory": ["sine_0p5hz"]}, where={}, across=columns,
        improvement_over="before",
    )  # fmt: skip
    # The two published values of 5.6: the text says 63 %.
    frame = pl.DataFrame(
        {
            "trajectory": ["sine_0p5hz"] * 2,
            "friction": ["unidirectional", "reduced"],
            "e_max_deg_mean": [4.53, 1.66],
            "e_max_deg_std": [0.1, 0.1],
            "n": [7, 7],
        }
    )
    row = arrange(frame, definition).rows[1]
    assert [cell.text for cell in row[1:]] == ["4.53 ± 0.10", "1.66 ± 0.10 (-63 %)"]


def test_two_numbers_that_vary_make_a_map() -> None:
    grid = {f"{a}_{b}": {"x": a, "y": b, "same": 1, "name": "n"} for a in (1.0, 2.0, 3.0) for b in (0.1, 0.2, 0.3)}
    assert varied_numbers(grid) == [("x", [1.0, 2.0, 3.0]), ("y", [0.1, 0.2, 0.3])]
    assert varied_numbers({name: one | {"name": name} for name, one in grid.items()}) is None
    assert varied_numbers({name: one | {"y": 0.1} for name, one in grid.items()}) is None
    svg = draw_map("title", ("x", [1.0, 2.0, 3.0]), ("y", [0.1, 0.2]), np.array([[1.0, 2.0, np.nan], [4.0, 5.0, 6.25]]))
    assert svg.startswith("<svg") and "6.25" in svg and "–" in svg


def test_the_leak_has_a_map_where_a_line_was_above_0p58() -> None:
    grid = [(x, y) for x in (0.1, 0.3, 0.45) for y in (0.05, 0.1, 0.2)]

    def headings(highest: float) -> set[str]:
        logs = []
        for x, y in grid:
            log = make_log("cycloid_pos", "pid")
            pressure = np.full(len(log.columns["time_s"]), highest)
            config = f"procedure: {{preload_mpa: {x}, adjustment: {{positive_mpa: {y}}}}}".encode()
            logs.append(
                replace(
                    log,
                    columns=log.columns | {"pressure1_mpa": pressure, "pressure2_mpa": pressure},
                    metadata={**log.metadata, "condition": f"{x}__{y}"},
                    attachments={**log.attachments, "config.yaml": config},
                )
            )
        return set(map_pictures(logs))

    usual = {"Map of RMSE1 (deg)", "Map of lowest line pressure (MPa gauge)"}
    assert headings(0.5) == usual
    assert headings(0.6) - usual == {"Map of time in which the fittings leak, above 0.58 MPa gauge (s)"}
