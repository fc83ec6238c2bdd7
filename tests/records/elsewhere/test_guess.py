"""The map that a header suggests: what is certain is written, all else is a question mark."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml
from foreign_truth import CASES, TIME, U, X, is_truth

from hjcamp.cli import run as main
from hjcamp.records.read import read_log

ROWS = list(zip(TIME, X, U, strict=True))
#: Lines above the rows, what is between cells, and the units that are expected of time, position, voltage (?: open).
HEADERS: dict[str, tuple[list[str], str, tuple[str, str, str]]] = {
    "brackets": (["time [s]", "position [mm]", "voltage [V]"], ",", ("s", "mm", "V")),
    "parentheses": (["Time (s)", "x (mm)", "U (V)"], ";", ("s", "mm", "V")),
    "underscores": (["t_s", "pos_mm", "u_v"], ",", ("s", "mm", "V")),
    "commas": (["Zeit, s", "Weg, mm", "Spannung, V"], ";", ("s", "mm", "V")),
    "strokes": (["t / s", "x / mm", "u / V"], "\t", ("s", "mm", "V")),
    "fields": (["time_s", "position_m", "voltage_v"], ",", ("s", "m", "V")),
    "a line of units": (["Time", "Position", "Drive\ns", "mm", "V"], ",", ("s", "mm", "V")),
    "units in brackets below": (["Time;Position;Drive\n(s);(mm);(V)"], ";", ("s", "mm", "V")),
    "no units": (["time", "position", "voltage"], ",", ("s", "?", "?")),
    "a preamble": (["Rig 3\nOperator: me\n\nTime [s]", "Carriage position [mm]", "Drive voltage [V]"], "\t", ("s", "mm", "V")),
    "camel case": (["elapsedTime_s", "carriagePosition_mm", "driveVoltage_V"], ",", ("s", "mm", "V")),
    "a remark": (["# t[s]", "x[mm]", "u[V]"], ",", ("s", "mm", "V")),
    "units alone say it": (["t [s]", "laser [mm]", "AO0 [V]"], ",", ("s", "mm", "V")),
    "quotes": (['"Time (s)"', '"Position (mm)"', '"Voltage (V)"'], ",", ("s", "mm", "V")),
    "blanks": (["t_s", "x_mm", "u_V"], " ", ("s", "mm", "V")),
    "channels": (["t [s]", "Channel 1", "Channel 2"], ",", ("s", "", "")),
    "two voltages": (["t [s]", "x [mm]", "AO0 [V]", "AO1 [V]"], ",", ("s", "mm", "")),
    "numbers alone": ([], ",", ("", "", "")),
}  # fmt: skip
FIELDS = ("time_s", "position_m", "voltage_v")


def write(path: Path, head: list[str], separator: str, columns: int = 3) -> None:
    lines = [separator.join(head)] if head else []
    lines += [separator.join(f"{one:.9g}" for one in (*row, row[2])[:columns]) for row in ROWS]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("case", HEADERS)
def test_what_a_header_says_is_written_and_the_rest_is_open(
    folder: Path, case: str, capsys: pytest.CaptureFixture[str]
) -> None:
    head, separator, units = HEADERS[case]
    write(Path("a.csv"), head, separator, 4 if case == "two voltages" else 3)
    assert main(["import", "a.csv", "--map", "new", "--plant", "stage"]) == 0
    said = capsys.readouterr().out
    guessed = yaml.safe_load(Path("a_map.yaml").read_text())
    fields = guessed["fields"] or {}
    for name, unit in zip(FIELDS, units, strict=True):
        rule = fields.get(name, {})
        assert (rule.get("unit") == unit and rule["column"] != "?") if unit else rule.get("column", "?") == "?", name
    complete = "?" not in units and "" not in units
    assert ("open (?)" in said) != complete
    code = main(["import", "a.csv", "--map", "a_map.yaml", "--output", "out.mcap"])
    if complete:
        assert code == 0
        columns = read_log("out.mcap").columns
        if case == "fields":
            columns["position_m"] = columns["position_m"] * 1e-3
        is_truth(columns)
    else:
        assert code == 2 and "still open: " in capsys.readouterr().err


def test_a_folder_is_imported_by_one_call(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("raw").mkdir()
    for number in range(3):
        write(Path(f"raw/{number}.csv"), ["t [s]", "x [mm]", "u [V]"], ",")
    Path("raw/notes.md").write_text("no table")
    assert main(["import", "raw", "--map", "new", "--plant", "stage", "--output", "map.yaml"]) == 2
    assert "give --into DIR" in capsys.readouterr().err
    assert main(["import", "raw/0.csv", "--map", "new", "--plant", "stage", "--output", "map.yaml"]) == 0
    assert main(["import", "raw", "--map", "map.yaml", "--into", "logs"]) == 0
    assert sorted(path.name for path in Path("logs").iterdir()) == ["0.mcap", "1.mcap", "2.mcap"]
    Path("empty").mkdir()
    assert main(["import", "empty", "--map", "map.yaml", "--into", "logs"]) == 2
    assert "no file that ends in" in capsys.readouterr().err


@pytest.mark.parametrize("name", sorted(one.name for one in CASES.iterdir() if (one / "expect.json").exists()))
def test_no_file_that_was_met_ends_in_a_traceback(folder: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    source = next(path for path in (CASES / name).iterdir() if path.name.startswith("input"))
    copy = Path(f"a{source.suffix}")
    shutil.copy(source, copy)
    code = main(["import", str(copy), "--map", "new", "--plant", "stage"])
    assert code in (0, 2) and "internal error" not in capsys.readouterr().err
    assert not code or not Path("a_map.yaml").exists()


def test_a_recording_of_numbers_has_a_guess_too(folder: Path) -> None:
    np.savez("a.npz", time_s=TIME, position_m=1e-3 * X, voltage_v=U, units=np.array('{"position_m": "m"}'))
    assert main(["import", "a.npz", "--map", "new", "--plant", "stage"]) == 0
    assert main(["import", "a.npz", "--map", "a_map.yaml", "--output", "out.mcap"]) == 0
    is_truth(read_log("out.mcap").columns)
