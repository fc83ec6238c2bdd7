"""Logs as tables for other programs: read back by these programs' own libraries, with units and metadata."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import polars
import pytest
from log_makers import make_log
from mcap.reader import make_reader
from scipy.io import loadmat

from hjcamp import cli
from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.read import read_log
from hjcamp.records.views.exporting import export_logs
from hjcamp.records.write import write_log


@pytest.fixture
def logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, TestLog]:
    """Two logs in folders of their own, with equal names."""
    monkeypatch.chdir(tmp_path)
    made = {}
    for place, condition in enumerate(("ramp", "cycloid")):
        log = make_log(samples=40 + place)
        (tmp_path / "logs" / condition).mkdir(parents=True)
        write_log(tmp_path / "logs" / condition / "1.mcap", log)
        made[f"{condition}__1"] = log
    return made


def export(kind: str) -> int:
    return cli.run(["log", "export", "logs", "--as", kind, "--into", "out"])


def test_the_log_itself_says_the_units_of_its_channel(logs: dict[str, TestLog]) -> None:
    with open("logs/ramp/1.mcap", "rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    [channel] = summary.channels.values()
    assert channel.metadata["unit.arm_deg"] == "deg" and channel.metadata["unit.pressure1_mpa"] == "MPa"
    assert set(channel.metadata) == {f"unit.{name}" for name in logs["ramp__1"].columns}


def test_parquet_has_columns_units_and_metadata(logs: dict[str, TestLog]) -> None:
    assert export("parquet") == 0
    for name, log in logs.items():
        table = polars.read_parquet(f"out/{name}.parquet")
        for field, values in log.columns.items():
            np.testing.assert_array_equal(table[field].to_numpy(), values)
        about = polars.read_parquet_metadata(f"out/{name}.parquet")
        assert json.loads(about["units"])["arm_deg"] == "deg"
        assert json.loads(about["hjcamp.test"])["condition"] == log.metadata["condition"]


def test_csv_has_a_file_of_units_beside_it(logs: dict[str, TestLog]) -> None:
    assert export("csv") == 0
    table = polars.read_csv("out/ramp__1.csv")
    np.testing.assert_array_equal(table["pressure1_mpa"].to_numpy(), logs["ramp__1"].columns["pressure1_mpa"])
    assert json.loads(Path("out/ramp__1.json").read_text(encoding="utf-8"))["units"]["time_s"] == "s"


def test_matlab_and_numpy_read_theirs(logs: dict[str, TestLog]) -> None:
    assert export("mat") == 0 and export("npz") == 0
    log = logs["cycloid__1"]
    content = loadmat("out/cycloid__1.mat", simplify_cells=True)
    with np.load("out/cycloid__1.npz") as arrays:
        for field, values in log.columns.items():
            np.testing.assert_array_equal(content[field], values)
            np.testing.assert_array_equal(arrays[field], values)
        assert json.loads(str(arrays["units"]))["dither_v"] == "V"
    assert content["units"]["arm_deg"] == "deg" and content["metadata"]["condition"] == log.metadata["condition"]


def test_what_cannot_be_exported_leaves_nothing(logs: dict[str, TestLog], capsys: pytest.CaptureFixture[str]) -> None:
    assert export("parquett") == 2
    assert "did you mean 'parquet'" in capsys.readouterr().err and not Path("out").exists()
    Path("out").mkdir()
    Path("out/ramp__1.npz").write_bytes(b"mine")
    assert export("npz") == 2
    assert "it is left as it is" in capsys.readouterr().err
    assert [path.name for path in Path("out").iterdir()] == ["ramp__1.npz"] and Path("out/ramp__1.npz").read_bytes() == b"mine"


def test_a_damaged_log_among_others_says_what_is_whole(tmp_path: Path) -> None:
    for name in "abcd":
        write_log(tmp_path / f"{name}.mcap", make_log(samples=50))
    (tmp_path / "c.mcap").write_bytes((tmp_path / "c.mcap").read_bytes()[:-40])
    with pytest.raises(UsageError, match=r"c\.mcap.*; 2 tables of 4 logs before it, in .*out, are whole"):
        export_logs(sorted(tmp_path.glob("*.mcap")), read_log, "csv", tmp_path / "out")
    assert sorted(one.name for one in (tmp_path / "out").iterdir()) == ["a.csv", "a.json", "b.csv", "b.json"]
