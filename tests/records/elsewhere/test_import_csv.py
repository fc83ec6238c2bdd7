"""Tables of other loggers become test logs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars
import pytest
import yaml

from hjcamp import cli
from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.importing import import_file, import_files
from hjcamp.records.read import read_log

MAPPING = {
    "separator": ";",
    "fields": {
        "time_s": {"column": "t", "unit": "ms"},
        "arm_deg": {"column": "theta", "unit": "rad", "sign": -1},
        "pressure1_mpa": {"column": "P1", "unit": "bar", "offset": -1.0},
        "pressure2_mpa": {"column": "P2", "unit": "kPa", "scale": 100.0},
        "pump_deg": {"column": "piston", "unit": "mm"},
    },
    "metadata": {"condition": "bench", "repetition": 3, "pump": "pump2"},
}


def table(rate: float, duration: float = 0.5, start: float = 12.0) -> np.ndarray:
    """Return rows of t (ms), theta (rad), P1 (bar absolute), P2 (V, 100 kPa each), piston (mm)."""
    time = np.arange(round(duration * rate)) / rate
    columns = (1e3 * (start + time), -np.sin(time), 4 + time, 3 + time, 2 * time)
    return np.stack(columns, axis=1)


def write_case(
    folder: Path, rows: np.ndarray, mapping: object = None, header: str = "t;theta;P1;P2;piston"
) -> tuple[Path, Path]:
    text = "\n".join([header, *(";".join(f"{value:.12g}" for value in row) for row in rows)])
    (folder / "bench.csv").write_text(text + "\n")
    (folder / "map.yaml").write_text(yaml.safe_dump(MAPPING if mapping is None else mapping))
    return folder / "bench.csv", folder / "map.yaml"


@pytest.mark.parametrize("rate", [200, 1000, 1024, 5000])
def test_units_signs_and_rate(tmp_path: Path, rate: float) -> None:
    import_file(*write_case(tmp_path, table(rate)), tmp_path / "out.mcap")
    log = read_log(tmp_path / "out.mcap")
    time = log.columns["time_s"]
    assert time[0] == 0 and abs(time[-1] - (0.5 - 1 / rate)) < 1e-3
    np.testing.assert_allclose(log.columns["arm_deg"], np.rad2deg(np.sin(time)), atol=2e-4)
    np.testing.assert_allclose(log.columns["pressure1_mpa"], 0.3 + 0.1 * time, atol=1e-9)
    np.testing.assert_allclose(log.columns["pressure2_mpa"], 0.3 + 0.1 * time, atol=1e-9)
    np.testing.assert_allclose(log.columns["pump_deg"], 720 * time, atol=1e-6)
    assert log.metadata == {"condition": "bench", "repetition": "3", "pump": "pump2"}
    assert yaml.safe_load(log.attachments["import.yaml"]) == MAPPING


def test_rate_instead_of_time_and_decimal_commas(tmp_path: Path) -> None:
    fields = {name: rule for name, rule in MAPPING["fields"].items() if name != "time_s"}  # type: ignore[attr-defined]
    mapping = MAPPING | {"fields": fields, "sampling_hz": 2000, "decimal_comma": True, "skip_lines": 1, "comment": "#"}
    source, rules = write_case(tmp_path, table(2000), mapping)
    source.write_text("made by a bench\n" + source.read_text().replace(".", ",") + "# end\n")
    log = import_file(source, rules, tmp_path / "out.mcap")
    assert log.samples == 500
    np.testing.assert_allclose(log.columns["pump_deg"], 720 * log.columns["time_s"], atol=1e-6)


def test_phase_is_held_and_sets_the_time(tmp_path: Path) -> None:
    rows = np.column_stack([table(500), np.where(np.arange(250) < 100, 2, 3)])
    mapping = MAPPING | {"fields": MAPPING["fields"] | {"phase": "phase"}}  # type: ignore[operator]
    import_file(*write_case(tmp_path, rows, mapping, "t;theta;P1;P2;piston;phase"), tmp_path / "out.mcap")
    log = read_log(tmp_path / "out.mcap")
    assert log.columns["time_s"][0] == pytest.approx(-0.2)
    np.testing.assert_array_equal(log.columns["phase"], np.where(log.columns["time_s"] < -1e-9, 2.0, 3.0))


KILLED = """
import os, signal, sys
from hjcamp import cli
from hjcamp.records import write
write.LogWriter.append_arrays = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
cli.run(["import", *sys.argv[1:]])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="kill -9")
def test_what_a_killed_import_left_goes_with_the_next(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source, rules = write_case(tmp_path, table(1000))
    words = [str(source), "--map", str(rules)]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    subprocess.run([sys.executable, "-c", KILLED, *words], env=environment, check=False)
    assert [path.name for path in tmp_path.glob("bench.mcap*")] == ["bench.mcap.part"]
    for left in (True, False):
        assert cli.run(["import", *words]) == 0
        assert ("bench.mcap.part, left by an import that was cut off, is gone" in capsys.readouterr().out) == left
        assert [path.name for path in tmp_path.glob("bench.mcap*")] == ["bench.mcap"]
        (tmp_path / "bench.mcap").unlink()


def edit(change: Callable[[dict], object]) -> dict:
    mapping = yaml.safe_load(yaml.safe_dump(MAPPING))
    change(mapping)
    return mapping


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: m["fields"].update(arm_degree="theta"), "unknown field 'arm_degree'.*did you mean 'arm_deg'"),
        (
            lambda m: m["fields"]["arm_deg"].update(unit="radien"),
            "unit of 'arm_deg' 'radien'.*Allowed: deg, rad, turn",
        ),
        (lambda m: m["fields"]["pressure1_mpa"].update(unit="mpa"), "unknown unit 'mpa'.*did you mean 'MPa'"),
        (lambda m: m["fields"]["arm_deg"].update(unit="mm"), "unknown unit of 'arm_deg' 'mm'"),
        (lambda m: m["fields"]["arm_deg"].update(colum="x"), "unknown key 'colum'.*did you mean 'column'"),
        (lambda m: m["fields"]["arm_deg"].pop("column"), "give the column"),
        (lambda m: m["fields"]["arm_deg"].update(column="Theta"), "unknown column 'Theta'.*did you mean 'theta'"),
        (lambda m: m["fields"]["arm_deg"].update(sign=2), "sign is 2; allowed: 1, -1"),
        (lambda m: m["fields"]["arm_deg"].update(scale="two"), "scale is 'two', not a finite number"),
        (lambda m: m["fields"]["arm_deg"].update(scale=0), "a scale of 0"),
        (lambda m: m["fields"].pop("arm_deg"), "required field 'arm_deg' is missing"),
        (lambda m: m["fields"].pop("pump_deg"), "neither 'pump_deg' nor 'command_deg'"),
        (lambda m: m["fields"].pop("time_s"), "give period_s or sampling_hz"),
        (lambda m: m.update(sampling_hz=100), "below 200 Hz"),
        (lambda m: m.update(sampling_hz=500), "1000 rows a second, sampling_hz is 500"),
        (lambda m: m["fields"]["time_s"].update(unit="s"), "is the unit of time_s right"),
        (lambda m: m.update(seperator=";"), "unknown key 'seperator'.*did you mean 'separator'"),
        (lambda m: m.update(separator="::"), "give one character"),
        (lambda m: m.update(separator=","), "unknown column 't'"),
        (lambda m: m.update(metadata=[1]), "metadata must be names"),
        (lambda m: m.pop("fields"), "expected a mapping with the fields"),
    ],
)
def test_a_bad_mapping_has_one_clear_message(tmp_path: Path, change: Callable[[dict], object], message: str) -> None:
    source, rules = write_case(tmp_path, table(1000), edit(change))
    with pytest.raises(UsageError, match=message) as caught:
        import_file(source, rules, tmp_path / "out.mcap")
    assert "\n" not in str(caught.value) and not (tmp_path / "out.mcap").exists()


@pytest.mark.parametrize(
    ("pattern", "replacement", "message"),
    [
        (r"\n12100;[^;]*;", "\n12100;oops;", "'theta' is no number in row 101: 'oops'"),
        (r"\n12100;[^;]*;", "\n12100;;", "'theta' is empty in row 101"),
        (r"\n12100;[^;]*;", "\n12100;NaN;", "'arm_deg' is nan at sample 100"),
        (r"\n1210[0-4];.*", "", "gap of 6 ms after row 100"),
        (r"\n12100;", "\n12098;", "time does not increase at row 101"),
        (r"\n12100;", "\n12099;", "1 row is lost of 500"),
        (r"\n12100;", "\n12100;1;2;3;4;5;6;", "cannot be read as a table"),
        (r"\n(.*\n)*", "\n", "0 rows are no test"),
        (r"(.|\n)*", "", "cannot be read as a table"),
    ],
)
def test_a_bad_table_has_one_clear_message(tmp_path: Path, pattern: str, replacement: str, message: str) -> None:
    source, rules = write_case(tmp_path, table(1000))
    source.write_text(re.sub(pattern, replacement, source.read_text()))
    with pytest.raises(UsageError, match=message) as caught:
        import_file(source, rules, tmp_path / "out.mcap")
    assert "\n" not in str(caught.value) and not (tmp_path / "out.mcap").exists()


def test_cells_without_a_value_are_filled_where_the_map_says_so(tmp_path: Path) -> None:
    source, rules = write_case(tmp_path, table(1000), edit(lambda m: m.update(gaps="interpolate")))
    whole = import_file(source, rules, tmp_path / "whole.mcap").columns["arm_deg"]
    text = re.sub(r"\n12100;[^;]*;", "\n12100;;", source.read_text())
    source.write_text(re.sub(r"\n12101;[^;]*;", "\n12101;NaN;", text))
    [one] = import_files([source], rules, [tmp_path / "out.mcap"])
    found = read_log(tmp_path / "out.mcap").columns["arm_deg"]
    other = np.flatnonzero(found != whole)
    assert set(other) <= {100, 101} and found[100] == pytest.approx((2.0 * whole[99] + whole[102]) / 3.0)
    assert [item.line for item in one.doubtful] == [
        "warning: 'arm_deg' has no value in 2 rows of 500, at most 2 in a row; filled in"
    ]
    source.write_text(source.read_text().replace("\n12103;", "\n;"))
    with pytest.raises(UsageError, match="'time_s' is nan at sample 103"):
        import_file(source, rules, tmp_path / "again.mcap")


def test_gaps_are_refused_or_interpolated(tmp_path: Path) -> None:
    source, rules = write_case(tmp_path, table(1000), edit(lambda m: m.update(gaps="interpolte")))
    with pytest.raises(UsageError, match=r"'interpolte' in gaps of .*did you mean 'interpolate'"):
        import_file(source, rules, tmp_path / "out.mcap")


@pytest.mark.parametrize(("cell", "said"), [("NaN", True), ("inf", False)])
def test_a_value_that_is_not_known_is_refused_with_what_would_fill_it_in(tmp_path: Path, cell: str, said: bool) -> None:
    source, rules = write_case(tmp_path, table(1000))
    lines = source.read_text().splitlines()
    first, mark, rest = lines[500].rpartition(";")
    assert mark and rest
    lines[500] = f"{first};{cell}"
    source.write_text("\n".join(lines))
    with pytest.raises(UsageError, match=r"is (nan|-?inf) at sample 499") as refused:
        import_file(source, rules, tmp_path / "out.mcap")
    assert ("gaps: interpolate" in str(refused.value)) is said


@pytest.mark.parametrize("separator", [";", ",", "\t", " "])
def test_a_table_of_more_columns_than_anybody_measures_is_refused(tmp_path: Path, separator: str) -> None:
    source, rules = write_case(tmp_path, table(1000))
    source.write_text("".join(separator.join(["1.5"] * 20_001) + "\n" for _ in range(3)))
    with pytest.raises(UsageError, match="20001 columns; a table has at most 20000"):
        import_file(source, rules, tmp_path / "out.mcap")
    wide = tmp_path / "wide.parquet"
    polars.DataFrame({f"c{k}": [1.5] for k in range(20_001)}).write_parquet(wide)
    with pytest.raises(UsageError, match="20001 columns"):
        import_file(wide, rules, tmp_path / "out.mcap")


def test_files_that_cannot_be_used(tmp_path: Path) -> None:
    source, rules = write_case(tmp_path, table(1000))
    with pytest.raises(UsageError, match="cannot be read"):
        import_file(tmp_path / "nothing.csv", rules, tmp_path / "out.mcap")
    with pytest.raises(UsageError, match="cannot be read"):
        import_file(source, tmp_path / "nothing.yaml", tmp_path / "out.mcap")
    rules.write_text("fields: [")
    with pytest.raises(UsageError, match=r"while parsing.* line 1"):
        import_file(source, rules, tmp_path / "out.mcap")
    (tmp_path / "out.mcap").write_bytes(b"")
    with pytest.raises(UsageError, match="exists already"):
        import_file(source, rules, tmp_path / "out.mcap")
