"""MATLAB, MCAP and Parquet files of other people's programs: read in any shape, or refused with what helps."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from datetime import datetime, time, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import polars
import pytest
import yaml
from foreign_truth import CASES, FIELDS, ROWS, TIME, U, X, imported, is_truth, mapped
from mcap.writer import CompressionType, Writer
from scipy.io import savemat

from hjcamp.errors import UsageError

BEGAN = datetime(2024, 2, 29, 23, 59, 58)


@pytest.mark.parametrize("case", sorted(one.name for one in CASES.iterdir() if (one / "expect.json").exists()))
def test_a_file_that_was_met_is_read_or_refused_with_what_helps(folder: Path, case: str) -> None:
    expect = json.loads((CASES / case / "expect.json").read_text())
    try:
        one, columns = imported(CASES / case / expect["input"], CASES / case / "map.yaml")
    except UsageError as refusal:
        said = str(refusal).replace(case, "")
        assert "\n" not in said and any(word in said for word in expect["say"])
        return
    told = " ".join(finding.line for finding in one.doubtful)
    if "warn" in expect:
        assert any(word.lower() in told.lower() for word in expect["warn"])
    elif "period" in expect:
        assert np.ptp(columns["time_s"]) / (len(columns["time_s"]) - 1) == pytest.approx(expect["period"], rel=1e-3)
    elif "near" in expect:
        rows = len(columns["time_s"])
        assert told and np.abs(1e3 * columns["position_m"] - X[:rows]).max() <= expect["near"]
    elif expect.get("xonly"):
        np.testing.assert_allclose(1e3 * columns["position_m"], X, atol=1e-3)
    else:
        is_truth(columns)


def structures(*signals: np.ndarray, name: str = "values") -> np.ndarray:
    found = np.empty((1, len(signals)), dtype=[(name, object), ("label", object)])
    for place, values in enumerate(signals):
        found[0, place] = (values, f"s{place}")
    return found


cell = np.empty((1, 2), dtype=object)
cell[0, 0], cell[0, 1] = X, U
MATS: dict[str, tuple[dict[str, Any], tuple[str, str, str]]] = {
    "structure with time": (
        {"S": {"time": TIME, "signals": structures(X, U)}},
        ("S.time", "S.signals(1).values", "S.signals(2).values"),
    ),
    "a recorder": (
        {"rec": {"X": structures(TIME, name="Data"), "Y": structures(X, U, name="Data")}},
        ("rec.X.Data", "rec.Y(1).Data", "rec.Y(2).Data"),
    ),
    "three dimensions of one signal": (
        {"t": TIME, "x": X.reshape(1, 1, -1), "u": U.reshape(1, -1, 1)},
        ("t", "x", "u"),
    ),
    "three dimensions of two": ({"t": TIME, "m": np.stack([X, U]).reshape(2, 1, -1)}, ("t", "m(1,1,:)", "m(2,1,:)")),
    "signals as rows": ({"m": np.stack([TIME, X, U])}, ("m(1,:)", "m(2,:)", "m(3,:)")),
    "signals as columns in a structure": (
        {"d": {"m": np.stack([TIME, X, U], axis=1)}},
        ("d.m(:,1)", "d.m(:,2)", "d.m( : , 3)"),
    ),
    "cells": ({"t": TIME, "c": cell}, ("t", "c{1}", "c{2}")),
    "an array of structures of one number": (
        {"t": TIME, "s": np.array([[(x, u) for x, u in zip(X, U, strict=True)]], dtype=[("x", float), ("u", float)])},
        ("t", "s.x", "s.u"),
    ),
}


@pytest.mark.parametrize("case", MATS)
def test_a_matlab_file_is_read_in_any_shape(folder: Path, case: str) -> None:
    content, (time_s, x, u) = MATS[case]
    savemat("file.mat", content)
    is_truth(
        imported(Path("file.mat"), mapped({"time_s": time_s, "position_m": {"column": x, "unit": "mm"}, "voltage_v": u}))[1]
    )


@pytest.mark.parametrize(
    ("x", "said"),
    [
        ("m", r"is a matrix \(3 x 600\); give one column or row of it: m\(1,:\)"),
        ("m(4,:)", r"size of 'm' is 3 x 600"),
        ("m(:)", "'m.:.' is not there|not equally long|size of"),
        ("S.signals", "struct with values"),
        ("S.signals.values", r"say which, S.signals\(1\).values"),
        ("S.signals(3).values", "size of 'S.signals' is 1 x 2"),
        ("S.sinals(1).values", "did you mean 'signals'"),
        ("m(", "write it as MATLAB does"),
    ],
)
def test_the_advice_for_a_matlab_file_leads_on(folder: Path, x: str, said: str) -> None:
    savemat("file.mat", {"t": TIME, "m": np.stack([TIME, X, U]), "S": {"signals": structures(X, U)}})
    with pytest.raises(UsageError, match=said):
        imported(Path("file.mat"), mapped({"time_s": "t", "position_m": x, "voltage_v": "m(3,:)"}))


Messages = list[tuple[str, float, dict[str, Any]]]


def write_mcap(path: Path, messages: Messages, **how: Any) -> Path:
    with path.open("wb") as stream:
        writer = Writer(stream, **how)
        writer.start()
        schema = writer.register_schema("any", "jsonschema", b"{}")
        channels = {
            topic: writer.register_channel(topic, "json", schema) for topic in dict.fromkeys(one for one, _, _ in messages)
        }
        for topic, at, content in sorted(messages, key=lambda one: one[1]):
            stamp = round(at * 1e9) + 1_700_000_000_000_000_000
            writer.add_message(channels[topic], stamp, json.dumps(content).encode(), stamp)
        writer.finish()
    return path


def states(content: Callable[[int], dict[str, Any]]) -> Messages:
    return [("/state", TIME[k], content(k)) for k in range(ROWS)]


CHANGES = [k for k in range(ROWS) if k == 0 or U[k] != U[k - 1]]
STAMPED = {"time_s": "header.stamp"}
MCAPS: dict[str, tuple[Messages, dict[str, Any]]] = {
    "arrays": (
        states(lambda k: {"position": [0.0, X[k]], "effort": [U[k]]}),
        {"position_m": {"column": "position[1]", "unit": "mm"}, "voltage_v": "effort[0]"},
    ),
    "objects in arrays": (
        states(lambda k: {"axes": [{"x": X[k], "u": [U[k]]}]}),
        {"position_m": {"column": "axes[0].x", "unit": "mm"}, "voltage_v": "axes[0].u[0]"},
    ),
    "a command when it changes": (
        states(lambda k: {"x": X[k]}) + [("/cmd", TIME[k], {"u": U[k]}) for k in CHANGES],
        {"voltage_v": {"column": "u", "topic": "/cmd"}},
    ),
    "a command between states": (
        states(lambda k: {"x": X[k]}) + [("/cmd", TIME[k] - 0.004, {"u": U[k]}) for k in range(ROWS)],
        {"voltage_v": {"column": "u", "topic": "/cmd"}},
    ),
    "a stamp of ROS 2": (
        states(
            lambda k: {
                "header": {"stamp": {"sec": 1_700_000_000 + k // 100, "nanosec": k % 100 * 10_000_000}},
                "x": X[k],
                "u": U[k],
            }
        ),
        STAMPED,
    ),
    "a stamp of ROS 1": (
        states(
            lambda k: {
                "header": {"stamp": {"secs": 1_700_000_000 + k // 100, "nsecs": k % 100 * 10_000_000}},
                "x": X[k],
                "u": U[k],
            }
        ),
        STAMPED,
    ),
    "a name with a point": (
        states(lambda k: {"arm.x": X[k], "u": U[k]}),
        {"position_m": {"column": "arm.x", "unit": "mm"}},
    ),
}


@pytest.mark.parametrize("case", MCAPS)
@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.LZ4])
def test_messages_need_not_be_flat_rows(folder: Path, case: str, compression: CompressionType) -> None:
    messages, fields = MCAPS[case]
    source = write_mcap(Path("file.mcap"), messages, compression=compression, chunk_size=4096)
    wanted = {name: rule for name, rule in (FIELDS | fields).items() if name != "time_s" or fields.get("time_s")}
    Path("map.yaml").write_text(yaml.safe_dump({"plant": "stage", "topic": "/state", "fields": wanted}))
    is_truth(imported(source, Path("map.yaml"))[1])


def test_true_and_false_are_numbers_and_null_is_a_gap(folder: Path) -> None:
    fields = {"position_m": {"column": "x", "unit": "mm"}, "voltage_v": "on"}
    source = write_mcap(
        Path("file.mcap"),
        states(lambda k: {"x": None if k in (5, 6) else X[k], "on": k % 7 < 3} if k != 9 else {"on": False}),
    )
    Path("map.yaml").write_text(yaml.safe_dump({"plant": "stage", "topic": "/state", "fields": fields}))
    with pytest.raises(UsageError, match="'x' is null in message 5 on /state; gaps: interpolate"):
        imported(source, Path("map.yaml"))
    Path("map.yaml").write_text(yaml.safe_dump({"plant": "stage", "topic": "/state", "fields": fields, "gaps": "interpolate"}))
    one, columns = imported(source, Path("map.yaml"))
    assert any("no value in 3 rows of 600, at most 2 in a row" in finding.line for finding in one.doubtful)
    np.testing.assert_array_equal(columns["voltage_v"], [k % 7 < 3 if k != 9 else 0 for k in range(ROWS)])


@pytest.mark.parametrize("share", [0.2, 0.35, 0.5, 0.65, 0.8, 0.95, 0.999])
def test_what_is_whole_of_a_recording_that_was_cut_off_is_read(folder: Path, share: float) -> None:
    source = write_mcap(Path("file.mcap"), states(lambda k: {"x": X[k], "u": U[k]}), chunk_size=2048)
    source.write_bytes(source.read_bytes()[: int(share * source.stat().st_size)])
    Path("map.yaml").write_text(
        yaml.safe_dump(
            {
                "plant": "stage",
                "topic": "/state",
                "fields": {"position_m": {"column": "x", "unit": "mm"}, "voltage_v": "u"},
            }
        )
    )
    one, columns = imported(source, Path("map.yaml"))
    assert any("truncated or was never finished: the whole messages are read" in finding.line for finding in one.doubtful)
    rows = len(columns["time_s"])
    assert rows > 0.5 * share * ROWS
    np.testing.assert_allclose(1e3 * columns["position_m"], X[:rows], atol=1e-9)


PARQUETS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "times of a day behind midnight": (
        {"t": [(BEGAN + timedelta(milliseconds=10 * k)).time() for k in range(ROWS)], "x": X, "u": U},
        {},
    ),
    "times of noon": ({"t": [time(12, 0, k // 100, k % 100 * 10_000) for k in range(ROWS)], "x": X, "u": U}, {}),
    "dates": ({"t": [BEGAN + timedelta(milliseconds=10 * k) for k in range(ROWS)], "x": X, "u": U}, {}),
    "structures": (
        {"t": TIME, "pose": [{"x": x, "y": 0.0} for x in X], "u": U},
        {"position_m": {"column": "pose.x", "unit": "mm"}},
    ),
    "lists": ({"t": TIME, "q": [[0.0, x] for x in X], "u": U}, {"position_m": {"column": "q[1]", "unit": "mm"}}),
    "lists of structures": (
        {"t": TIME, "q": [[{"x": x}] for x in X], "u": U},
        {"position_m": {"column": "q[0].x", "unit": "mm"}},
    ),
    "texts": ({"t": [f"00:00:{one:05.2f}" for one in TIME], "x": X, "u": U}, {}),
}


@pytest.mark.parametrize("case", PARQUETS)
def test_columns_of_parquet_may_be_of_any_type(folder: Path, case: str) -> None:
    content, fields = PARQUETS[case]
    polars.DataFrame(content).write_parquet("file.parquet")
    is_truth(imported(Path("file.parquet"), mapped(fields))[1])


@pytest.mark.parametrize(
    ("x", "said"),
    [
        ("pose", "name what is within it: pose.NAME"),
        ("q", r"name one of its values: q\[0\]"),
        ("pose.z", "Allowed: x, y"),
    ],
)
def test_the_advice_for_a_column_of_parquet_leads_on(folder: Path, x: str, said: str) -> None:
    polars.DataFrame({"t": TIME, "pose": [{"x": one, "y": 0.0} for one in X], "q": [[one] for one in X], "u": U}).write_parquet(
        "file.parquet"
    )
    with pytest.raises(UsageError, match=re.compile(said)):
        imported(Path("file.parquet"), mapped({"position_m": x}))
