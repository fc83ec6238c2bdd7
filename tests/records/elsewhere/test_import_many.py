"""A folder of files by one map: one table of what was read and what looks wrong, one file in memory at a time."""

from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from foreign_truth import mapped
from jsonschema import validate

from hjcamp import cli
from hjcamp.errors import UsageError
from hjcamp.records import write
from hjcamp.records.elsewhere.importing import import_files
from hjcamp.records.log import TestLog
from hjcamp.records.read import read_log
from hjcamp.records.sets import look
from hjcamp.records.sets.look import look_at, look_one_by_one
from hjcamp.records.stored import stored_logs
from hjcamp.records.write import check_samples

SCHEMA = json.loads((Path(__file__).parents[3] / "docs" / "schemas" / "hjcamp.import-1.json").read_text())
ROWS = 600
Rows = np.ndarray


def rows_of(number: int) -> Rows:
    """One test (rows, 3): t in s, x in mm with noise, u in V."""
    generator = np.random.default_rng(number)
    time = 0.01 * np.arange(ROWS)
    x = 20.0 * np.sin(2.0 * np.pi * (0.3 + 0.01 * number) * time) + 0.01 * generator.standard_normal(ROWS)
    return np.column_stack([time, x, 5.0 * np.cos(2.0 * np.pi * 0.5 * time)])


def uneven(rows: Rows) -> Rows:
    return rows + np.outer(0.002 * np.random.default_rng(1).uniform(-1.0, 1.0, ROWS), [1.0, 0.0, 0.0])


def lost(rows: Rows) -> Rows:
    return np.delete(rows, 300, axis=0)


def clipped(rows: Rows) -> Rows:
    return np.minimum(rows, [np.inf, 15.0, np.inf])


def spike(rows: Rows) -> Rows:
    rows[200, 1] += 400.0
    return rows


def still(rows: Rows) -> Rows:
    return np.column_stack([rows[:, :2], np.full(ROWS, 3.0)])


SPOILT: dict[str, tuple[Callable[[Rows], Rows], str, str]] = {
    "clock": (uneven, "clock", "time_s"),
    "lost": (lost, "gaps", "time_s"),
    "clipped": (clipped, "saturation", "position_m"),
    "spike": (spike, "spikes", "position_m"),
    "constant": (still, "constant", "voltage_v"),
}


def write_csv(path: Path, rows: Rows) -> None:
    path.parent.mkdir(exist_ok=True)
    np.savetxt(path, rows, "%.6g", ",", header="t,x,u", comments="")


def folder_of(count: int) -> None:
    for number in range(count):
        write_csv(Path(f"raw/test_{number:02d}.csv"), rows_of(number))


def test_a_folder_ends_in_one_table_that_names_what_is_spoilt(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder_of(34)
    for number, (name, (spoil, _, _)) in enumerate(SPOILT.items()):
        write_csv(Path(f"raw/{name}.csv"), spoil(rows_of(50 + number)))
    write_csv(Path("raw/z_copy.csv"), rows_of(7))
    mapping = mapped({}, gaps="interpolate")
    call = ["import", "raw", "--map", str(mapping), "--into", "logs", "--json", "i.json"]
    assert cli.run(call) == 0, capsys.readouterr().err
    out = capsys.readouterr().out
    answer = json.loads(Path("i.json").read_text())
    validate(answer, SCHEMA)
    found = {Path(one["file"]).stem: {(each["kind"], each["field"]) for each in one["remarks"]} for one in answer["logs"]}
    for name, (_, kind, field) in SPOILT.items():
        assert (kind, field) in found.pop(name), name
    assert found.pop("z_copy") == {("copy", "")}
    # a sound file has no remark
    assert len(found) == 34 and not any(found.values())
    table = out[out.index("file ") :].splitlines()
    assert table[0].split() == ["file", "samples", "s", "Hz", "remarks"] and len(table) == 1 + 40 + 2
    assert next(line for line in table if line.startswith("test_03.csv")).split() == ["test_03.csv", "600", "6.000", "100", "-"]
    assert next(line for line in table if line.startswith("spike.csv")).endswith("spikes position_m")
    assert table[-2] == "40 files: 40 read, 6 of them with remarks; 24000 samples, 239.999 s"


def test_files_that_cannot_be_read_are_all_named_and_left_out_on_request(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder_of(7)
    Path("raw/a_text.csv").write_text("t,x,u\n0,a,1\n1,b,2\n")
    Path("raw/b_empty.csv").write_text("")
    call = ["import", "raw", "--map", str(mapped()), "--into", "logs", "--json", "i.json"]
    assert cli.run(call) == 2
    said = capsys.readouterr()
    assert "a_text.csv: 'x' is no number in row 1" in said.err and "1 more file" in said.err and "--skip" in said.err
    assert said.out.count("not read:") == 2 and not list(Path("logs").glob("*")) and not Path("i.json").exists()
    assert cli.run([*call, "--skip"]) == 0
    assert len(list(Path("logs").glob("*.mcap"))) == 7
    answer = json.loads(Path("i.json").read_text())
    validate(answer, SCHEMA)
    assert [Path(one["file"]).name for one in answer["not_read"]] == ["a_text.csv", "b_empty.csv"]
    assert "9 files: 7 read, 0 of them with remarks, 2 not read" in capsys.readouterr().out


def test_of_many_files_those_without_a_remark_are_counted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder_of(65)
    write_csv(Path("raw/odd.csv"), spike(rows_of(3)))
    assert cli.run(["import", "raw", "--map", str(mapped()), "--into", "logs"]) == 0, capsys.readouterr().err
    out = capsys.readouterr().out
    assert "and 65 files without a remark" in out and "odd.csv" in out and "test_03.csv" not in out


def test_memory_does_not_grow_with_the_number_of_files(folder: Path) -> None:
    """Of columns and of what is kept to look at a set: numpy's memory, at most, of 3 and of 12 files of 20 000 rows."""
    for number in range(12):
        write_csv(Path(f"raw/{number}.csv"), np.tile(rows_of(number), (34, 1)))
    mapping = mapped({"time_s": "t"}, period_s=0.01)
    mapping.write_text(mapping.read_text().replace("  time_s: t\n", ""))
    files = sorted(Path("raw").glob("*.csv"))

    def peak(count: int) -> int:
        tracemalloc.start()
        outs = [Path(f"logs_{count}/{one.stem}.mcap") for one in files[:count]]
        import_files(files[:count], mapping, outs)
        look_one_by_one(stored_logs(outs))
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return found

    peak(1)
    assert peak(12) < 1.15 * peak(3)


def test_logs_looked_at_one_by_one_are_looked_at_as_a_set(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the repetitions of one condition are more than fit into memory at once."""
    for number in range(8):
        rows = rows_of(3 if number == 6 else number)
        condition = "same" if number < 7 else "other"
        columns = {"time_s": 0.01 * np.arange(ROWS), "position_m": 1e-3 * rows[:, 1], "voltage_v": rows[:, 2]}
        metadata = {"plant": "stage", "period_s": "0.01", "condition": condition, "repetition": str(number)}
        write.write_log(Path(f"logs/{number}.mcap"), TestLog(columns, metadata))
    paths = sorted(Path("logs").glob("*.mcap"))
    copies = {one.log.path for one in look_at([read_log(path) for path in paths]) if one.original is not None}
    assert copies == {Path("logs/6.mcap")}
    monkeypatch.setattr(look, "ROOM_BYTES", 2 * paths[0].stat().st_size)
    found = look_one_by_one(stored_logs(paths))
    assert {one.log.path for one in found if one.original is not None} == copies


@pytest.mark.parametrize("fields", [2, 3, 16, 40])
def test_a_log_that_no_command_would_read_is_refused_before_it_is_written(fields: int) -> None:
    from hjcamp.records.mcap.layout import record_dtype

    size = record_dtype(tuple(range(1, fields + 1))).itemsize
    with pytest.raises(UsageError, match="more than a test log holds") as refusal:
        check_samples(10**7, fields, "a.csv")
    most = int(str(refusal.value).split("holds (")[1].split(")")[0])
    check_samples(most, fields, "a.csv")
    assert most * size <= 256 * 2**20 and most < 4_000_000
