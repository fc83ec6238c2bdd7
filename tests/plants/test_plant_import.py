"""Measurements of any plant, in any of the formats, become the same test log; what cannot be is one message."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars
import pytest
import yaml
from import_samples import (
    FIELDS,
    measured,
    write_csv,
    write_json_mcap,
    write_map,
    write_mat,
    write_parquet,
    write_protobuf_mcap,
)

from hjcamp import cli
from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.importing import import_file
from hjcamp.records.read import read_log
from hjcamp.records.units import conversion_to_field

AT_POSE = {"column": "pose.x", "unit": "mm", "sign": -1, "offset": 12.5}
UNTIMED = {name: FIELDS[name] for name in ("position_m", "voltage_v")}
POSE = FIELDS | {"position_m": AT_POSE}
FORMATS: dict[str, tuple[Callable[..., Path], dict[str, Any]]] = {
    "run.csv": (write_csv, {}),
    "run.parquet": (write_parquet, {}),
    "run.mat": (write_mat, {}),
    "struct.mat": (write_mat, {"fields": FIELDS | {"position_m": AT_POSE | {"column": "data.x"}}}),
    "matrix.mat": (write_mat, {"fields": FIELDS | {"position_m": AT_POSE | {"column": "m(:,2)"}}}),
    "run.mcap": (write_json_mcap, {"topic": "/motor/state"}),
    "inner.mcap": (write_json_mcap, {"topic": "/motor/state", "fields": POSE}),
    "proto.mcap": (write_protobuf_mcap, {"topic": "/motor/state", "fields": POSE}),
    "untimed.csv": (write_csv, {"fields": UNTIMED, "period_s": 0.001}),
    "stamped.mcap": (write_json_mcap, {"topic": "/motor/state", "fields": UNTIMED}),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_gives_the_same_log(folder: Path, name: str) -> None:
    columns = measured()
    write, change = FORMATS[name]
    log = import_file(write(folder / name, columns), write_map(folder, **change), folder / "out.mcap")
    np.testing.assert_array_equal(log.columns["time_s"], np.arange(400) * 1e-3)
    np.testing.assert_array_equal(log.columns["position_m"], -(columns["x"] + 12.5) * 1e-3)
    np.testing.assert_array_equal(log.columns["voltage_v"], 2.5 * columns["u"])
    assert log.metadata == {"plant": "axis", "period_s": "0.001", "condition": Path(name).stem, "mass_kg": "95"}


def test_a_slow_plant_stays_slow(folder: Path) -> None:
    rows = np.random.default_rng(2).normal(5.0, 0.1, (50, 2))
    polars.DataFrame({"minute": np.arange(50) / 15.0, "level": rows[:, 0], "pump": rows[:, 1]}).write_csv("tanks.csv")
    fields = {"time_s": {"column": "minute", "unit": "min"}, "level_v": "level", "pump_v": "pump"}
    log = import_file("tanks.csv", write_map(folder, plant="tanks", fields=fields), "out.mcap")
    assert log.period == 4.0 and log.duration == 200.0
    np.testing.assert_array_equal(log.columns["level_v"], rows[:, 0])


def test_rows_that_jitter_are_put_on_a_steady_clock_and_inputs_hold(folder: Path) -> None:
    columns = measured(rows=500, period=0.02)
    columns["t"] = columns["t"] + np.random.default_rng(1).uniform(-3.0, 3.0, 500)
    columns["x"] = 0.5 * columns["t"]
    columns["u"] = np.where(np.arange(500) < 250, 1.0, -1.0)
    log = import_file(write_csv(folder / "a.csv", columns), write_map(folder), "out.mcap")
    assert log.period == pytest.approx(0.02, rel=1e-3) and abs(log.samples - 500) <= 1
    np.testing.assert_allclose(np.diff(log.columns["time_s"]), log.period, rtol=1e-9)
    start = columns["t"][0]
    np.testing.assert_allclose(
        log.columns["position_m"], -(0.5 * (start + 1e3 * log.columns["time_s"]) + 12.5) * 1e-3, atol=1e-9
    )
    assert set(log.columns["voltage_v"]) == {2.5, -2.5}
    assert read_log("out.mcap").samples == log.samples


def test_a_clock_of_rounded_times_keeps_its_rows(folder: Path) -> None:
    columns = measured(rows=1024, period=1 / 1024)
    columns["t"] = np.round(columns["t"], 3)
    log = import_file(write_csv(folder / "a.csv", columns), write_map(folder), "out.mcap")
    assert log.samples == 1024 and log.period == pytest.approx(1 / 1024, rel=1e-6)
    np.testing.assert_array_equal(log.columns["voltage_v"], 2.5 * columns["u"])


def test_times_may_be_dates(folder: Path) -> None:
    columns = measured()
    moments = polars.Series(np.datetime64("2026-11-21T05:00:00") + (1e3 * columns["t"]).astype("timedelta64[us]"))
    polars.DataFrame({**columns, "t": moments}).write_parquet("a.parquet")
    fields = FIELDS | {"time_s": "t"}
    log = import_file("a.parquet", write_map(folder, fields=fields), "out.mcap")
    assert log.samples == 400 and log.metadata["period_s"] == "0.001"


def test_several_files_have_their_own_metadata(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("light.csv", "heavy.csv"):
        write_csv(folder / name, measured())
    files = {"light.csv": {"mass_kg": 95}, "heavy": {"mass_kg": 120, "condition": "loaded"}}
    write_map(folder, files=files)
    assert cli.run(["import", "light.csv", "heavy.csv", "--map", "map.yaml", "--into", "logs"]) == 0
    assert "next  hjcamp compare logs" in capsys.readouterr().out
    light, heavy = (read_log(f"logs/{name}.mcap") for name in ("light", "heavy"))
    assert (light.metadata["condition"], light.metadata["mass_kg"]) == ("light", "95")
    assert (heavy.metadata["condition"], heavy.metadata["mass_kg"]) == ("loaded", "120")
    assert light.attachments["import.yaml"] == (folder / "map.yaml").read_bytes()


def test_a_log_that_no_analysis_takes_is_told(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, rows in (("short.csv", 63), ("long.csv", 64)):
        write_csv(folder / name, measured(rows))
    write_map(folder)
    assert cli.run(["import", "short.csv", "long.csv", "--map", "map.yaml", "--into", "logs"]) == 0
    told = [line for line in capsys.readouterr().err.splitlines() if "leaves out" in line]
    assert told == ["logs/short.mcap: warning: 63 samples; an analysis leaves out logs of fewer than 64"]


def test_one_bad_file_of_several_leaves_no_log(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_csv(folder / "good.csv", measured())
    bad = measured()
    bad["x"][7] = np.nan
    write_csv(folder / "bad.csv", bad)
    write_map(folder)
    assert cli.run(["import", "good.csv", "bad.csv", "--map", "map.yaml", "--into", "logs"]) == 2
    assert "bad.csv: 'position_m' is nan at sample 7" in capsys.readouterr().err
    assert not list(Path("logs").glob("*"))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["a.csv", "b.csv", "--output", "x.mcap"], "there are 2 files; give --into DIR"),
        (["a.csv", "--into", "logs", "--output", "x.mcap"], "not both"),
        (["a.csv", "--into", "a.csv"], "this is a file; give a folder"),
        (["a.csv", "more/a.csv", "--into", "logs"], "would be the log of a.csv and of more/a.csv"),
        (["m.mcap"], "this is an MCAP file itself; give --into DIR or --output FILE"),
        (["nothing.csv"], "nothing.csv: cannot be read: No such file"),
        (["empty"], "empty: this folder has no file that ends in .asc, .csv"),
        (["c.csv"], "unknown file 'c.csv' in the files of map.yaml"),
    ],
)
def test_a_bad_call_is_one_message(folder: Path, words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "more").mkdir()
    (folder / "empty").mkdir()
    for name in ("a.csv", "b.csv", "c.csv", "more/a.csv"):
        write_csv(folder / name, measured())
    write_json_mcap(folder / "m.mcap", measured())
    files = {name: {} for name in ("a.csv", "b.csv", "m.mcap", "nothing.csv", "more")}
    write_map(folder, files=files, topic="/motor/state")
    assert cli.run(["import", *words, "--map", "map.yaml"]) == 2
    message = capsys.readouterr().err
    assert told in message and message.count("\n") == 1
    assert [path.name for path in folder.rglob("*.mcap*")] == ["m.mcap"]


def field(name: str, **change: object) -> dict[str, Any]:
    rule = {key: value for key, value in (FIELDS[name] | change).items() if value is not None}
    return {"fields": FIELDS | {name: rule}}


def less(name: str) -> dict[str, Any]:
    return {"fields": {key: value for key, value in FIELDS.items() if key != name}}


BAD_MAPS: dict[str, tuple[dict[str, Any], str]] = {
    "an unknown plant": ({"plant": "axes"}, "unknown plant 'axes' in .*did you mean 'axis'"),
    "another plant's field": (
        {"fields": FIELDS | {"level_v": "u"}},
        r"unknown field 'level_v' in .*plant axis.*'level_v' is a field of plant tanks: write plant: tanks",
    ),
    "our joint's field": ({"fields": {"arm_deg": "x"}}, "'arm_deg' is a field of plant pump_joint"),
    "no plant": ({"plant": None}, "'position_m' is a field of plant axis: write plant: axis"),
    "a unit that does not fit": (
        field("position_m", unit="V"),
        "'V' is a unit of a voltage, and 'position_m' is a length",
    ),
    "a unit of another size": (field("position_m", unit="MM"), "unknown unit 'MM'.*did you mean 'mm'"),
    "a missing input": (less("voltage_v"), "required field 'voltage_v' is missing"),
    "no time": (less("time_s"), "give period_s or sampling_hz, or map a column to time_s"),
    "two periods": ({"period_s": 0.1, "sampling_hz": 10}, "not both"),
    "no period": ({"period_s": 0}, "period_s is 0; allowed: 1e-05 to 86400"),
    "a wrong period": ({"period_s": 0.002}, "1000 rows a second, period_s is 0.002"),
    "a wrong rate": ({"sampling_hz": 500}, "1000 rows a second, sampling_hz is 500"),
    "no rate": ({"sampling_hz": -1}, "sampling_hz is -1; at least"),
    "a missing column": (field("position_m", column="X"), "unknown column 'X' in .*Allowed: t, u, x"),
    "a column called on": (
        field("position_m", column=True),
        "YAML reads this column as true; write its name in quotes",
    ),
    "a column that is a list": (field("position_m", column=[1]), r"reads this column as \[1\]; write its name in quotes"),
    "the plant as metadata": ({"metadata": {"plant": "axis"}}, "plant is written by the import"),
    "files that are none": ({"files": ["a.csv"]}, "files must be file names"),
    "a plant that is a list": ({"plant": ["axis"]}, r"plant is \['axis'\]; a name is needed"),
    "a huge number": (field("position_m", scale=10**400), "not a finite number"),
    "many lines": ({"skip_lines": 1e300}, "skip_lines is 1e\\+300; a whole number"),
}


@pytest.mark.parametrize("case", BAD_MAPS)
def test_a_bad_map_is_one_message(folder: Path, case: str) -> None:
    change, told = BAD_MAPS[case]
    with pytest.raises(UsageError, match=told) as caught:
        import_file(write_csv(folder / "a.csv", measured()), write_map(folder, **change), "out.mcap")
    assert "\n" not in str(caught.value) and not Path("out.mcap").exists()


def spoil(name: str, rows: slice, value: object) -> Callable[[dict[str, np.ndarray]], object]:
    return lambda columns: columns[name].__setitem__(rows, value)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (spoil("x", slice(None), 3.0), "'position_m' is -0.0155 m in all 400 samples; a sensor has noise"),
        (spoil("t", slice(200, 201), 198.0), "time does not increase at row 201"),
        (
            lambda columns: columns["t"].__setitem__(slice(200, None), columns["t"][200:] + 5.0),
            "gap of 6 ms after row 200 .*, where rows are 1 ms apart; import what is before and after it as tests of their own",
        ),
        (lambda columns: columns.update(t=columns["t"] * 1e-6), "no logger is faster"),
        (spoil("u", slice(9, 10), 1.7e308), "'voltage_v' is inf at sample 9"),
        (lambda columns: columns.update(t=columns["t"] * 1e9), "is the unit of time_s right"),
        (lambda columns: columns.update({name: values[:1] for name, values in columns.items()}), "1 row is no test"),
    ],
)
def test_a_table_that_cannot_be_is_one_message(folder: Path, change: Callable[..., object], told: str) -> None:
    columns = measured()
    change(columns)
    with pytest.raises(UsageError, match=told) as caught:
        import_file(write_csv(folder / "a.csv", columns), write_map(folder), "out.mcap")
    assert "\n" not in str(caught.value) and not Path("out.mcap").exists()


def test_as_many_rows_a_second_as_allowed_are_not_too_many_for_their_rounding(folder: Path) -> None:
    columns = measured()
    columns["t"] = 0.7 + columns["t"] * 1e-2  # 100 kHz, in a table that does not begin at 0
    import_file(write_csv(folder / "a.csv", columns), write_map(folder), "out.mcap")
    assert Path("out.mcap").exists()


HDF5 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM" + bytes(384) + b"\x89HDF\r\n\x1a\n"
BAD_FILES: list[tuple[str, Callable[[Path], object], dict[str, Any], str]] = [
    ("a.mat", lambda path: path.write_bytes(HDF5), {}, "cannot be read as a file of MATLAB 7.3"),
    ("a.mat", lambda path: path.write_bytes(b"no such thing" * 40), {}, "cannot be read as a MATLAB file"),
    ("a.mat", lambda path: path.write_bytes(b""), {}, "cannot be read as a MATLAB file"),
    (
        "a.mat",
        lambda path: write_mat(path, measured()),
        field("position_m", column="y"),
        "unknown variable 'y'.*Allowed: data, m",
    ),
    (
        "a.mat",
        lambda path: write_mat(path, measured()),
        field("position_m", column="m"),
        r"a matrix \(400 x 3\).*m\(:,1\)",
    ),
    (
        "a.mat",
        lambda path: write_mat(path, measured()),
        field("position_m", column="m(:,4)"),
        "the size of 'm' is 400 x 3",
    ),
    (
        "a.mat",
        lambda path: write_mat(path, measured()),
        field("position_m", column="data.y"),
        "unknown field 'y' in 'data'",
    ),
    ("a.mat", lambda path: write_mat(path, measured()), field("position_m", column="data"), "holds a struct with x"),
    (
        "a.mat",
        lambda path: write_mat(path, measured()),
        field("position_m", column="text"),
        "'text' holds no real numbers",
    ),
    ("a.parquet", lambda path: path.write_bytes(b"PAR1" + bytes(90) + b"PAR1"), {}, "cannot be read as Parquet"),
    (
        "a.parquet",
        lambda path: polars.DataFrame(measured()).with_columns(x=polars.lit(None, polars.Float64)).write_parquet(path),
        {},
        "'x' is empty in row 1",
    ),
    (
        "a.parquet",
        lambda path: polars.DataFrame(measured()).with_columns(x=polars.lit([1.0])).write_parquet(path),
        {},
        "'x' holds List",
    ),
    ("a.mcap", lambda path: path.write_bytes(b"no such thing"), {"topic": "/m"}, "is not an MCAP file"),
    ("a.mcap", lambda path: write_json_mcap(path, measured()), {}, "give the topic of .*one of /other, /motor/state"),
    ("a.mcap", lambda path: write_json_mcap(path, measured()), {"topic": "/motor"}, "unknown topic '/motor'"),
    (
        "a.mcap",
        lambda path: write_json_mcap(path, measured(), encoding="cdr"),
        {"topic": "/motor/state"},
        "are in cdr; their schema is to be in ros2msg",
    ),
    (
        "a.mcap",
        lambda path: write_json_mcap(path, measured()),
        {"topic": "/motor/state"} | field("position_m", column="y"),
        "unknown name 'y' in the messages on /motor/state of .*Allowed: on, pose, t, u, x",
    ),
    (
        "a.mcap",
        lambda path: write_json_mcap(path, measured()),
        {"topic": "/motor/state"} | field("position_m", column="pose"),
        "'pose' is no number in message 0",
    ),
    (
        "a.mcap",
        lambda path: write_protobuf_mcap(path, measured()),
        {"topic": "/motor/state"} | field("position_m", column="pose"),
        "'pose' is no number in message 0",
    ),
    (
        "a.xlsx",
        lambda path: path.write_bytes(b"PK\3\4" + bytes(90)),
        {},
        "cannot be read as a workbook",
    ),
    (
        "a.bin",
        lambda path: path.write_bytes(bytes(90)),
        {},
        "no table of text in UTF-8; those, .*.mat, .*.parquet, .*can be read",
    ),
    ("a.csv", lambda path: write_csv(path, measured()), {"topic": "/m"} | less("time_s"), "a.csv has no times"),
]


@pytest.mark.parametrize("number", range(len(BAD_FILES)))
def test_a_file_that_cannot_be_read_is_one_message(folder: Path, number: int) -> None:
    name, write, change, told = BAD_FILES[number]
    write(folder / name)
    with pytest.raises(UsageError, match=told) as caught:
        import_file(folder / name, write_map(folder, **change), "out.mcap")
    assert "\n" not in str(caught.value) and not Path("out.mcap").exists()


GIVEN = '    supply = Parameter("Pa", 0.6e6, (1e5, 1e6), given="supply_mpa")\n    gain ='


def test_what_each_test_is_given_is_checked(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "plants" / "axis.py"
    path.write_text(path.read_text().replace("    gain =", GIVEN, 1))
    write_csv(folder / "a.csv", measured())
    for value, told in ((6.0, "supply_mpa is '6.0'; a number from 0.1 to 1 MPa is needed"), ("much", "is 'much'")):
        write_map(folder, metadata={"supply_mpa": value})
        assert cli.run(["import", "a.csv", "--map", "map.yaml"]) == 2
        assert told in capsys.readouterr().err
    write_map(folder)
    assert cli.run(["import", "a.csv", "--map", "map.yaml"]) == 0
    assert "warning: the metadata do not give 'supply_mpa'" in capsys.readouterr().err
    write_map(folder, metadata={"supply_mpa": 0.5})
    assert cli.run(["import", "a.csv", "--map", "map.yaml", "--output", "b.mcap"]) == 0
    assert "supply_mpa" not in capsys.readouterr().err and read_log("b.mcap").metadata["supply_mpa"] == "0.5"


@pytest.mark.parametrize("plant", ["axis", "tanks", "pump_joint"])
def test_the_map_that_plants_shows_imports_as_it_is(folder: Path, plant: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["plants", plant]) == 0
    shown = capsys.readouterr().out
    text = shown[re.search(r"^plant: ", shown, re.M).start() :]  # type: ignore[union-attr]
    content = yaml.safe_load(text)
    assert content["plant"] == plant
    generator = np.random.default_rng(4)
    names = [one for one in content["fields"] if one != "time_s"]
    table = {"time_s": np.arange(300) * 1e-3} | {name: generator.normal(0.3, 1e-3, 300) for name in names}
    write_csv(folder / "run.csv", table)
    (folder / "map.yaml").write_text(text)
    assert cli.run(["import", "run.csv", "--map", "map.yaml"]) == 0
    log = read_log("run.mcap")
    assert log.metadata["condition"] == "run" and set(log.columns) == set(table)
    optional = yaml.safe_load(text.replace("\n  # ", "\n  "))["fields"]
    assert set(log.table.names) == set(optional)
    for name, rule in optional.items():
        assert conversion_to_field(log.table.field(name), rule["unit"], "here").factor == 1.0


def test_help_shows_a_map(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["import", "--help"]) == 0
    told = capsys.readouterr().out
    assert "plant: axis" in told and "{file}" in told and "--into" in told


def test_a_reader_that_panics_is_one_message(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def panics(*_: object, **__: object) -> None:
        os.write(2, b"thread 'async-executor-0' panicked\nstack backtrace:\n")
        raise polars.exceptions.PanicException("assertion failed\nstack")

    write_parquet(folder / "a.parquet", measured())
    write_map(folder)
    monkeypatch.setattr(polars, "read_parquet", panics)
    assert cli.run(["import", "a.parquet", "--map", "map.yaml"]) == 2
    assert capfd.readouterr().err == "hjcamp: a.parquet: cannot be read as Parquet: assertion failed\n"


def test_two_fields_of_one_column_are_told(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_csv(folder / "a.csv", measured())
    fields = {**FIELDS, "voltage_v": {"column": "x", "unit": "V"}}
    write_map(folder, fields=fields)
    assert cli.run(["import", "a.csv", "--map", "map.yaml"]) == 0
    assert "warning: position_m and voltage_v are made of one column, 'x'" in capsys.readouterr().err
    write_map(folder)
    assert cli.run(["import", "a.csv", "--map", "map.yaml", "--output", "b.mcap"]) == 0
    assert "one column" not in capsys.readouterr().err
