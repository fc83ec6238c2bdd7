"""Tables as odd programs write them: the guessed map is imported as it is and gives the truth, or asks; none is silently wrong."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
import yaml
from foreign_truth import TIME, U, X, is_truth

from hjcamp.cli import run as main
from hjcamp.records.elsewhere.text_head import unit_in
from hjcamp.records.read import read_log

BEGAN = datetime(2024, 3, 5, 11, 59, 58)
BRACKETS = "t [s]|x [mm]|u [V]"


def table(
    head: str, separator: str = ",", times: object = TIME, comma: bool = False, form: str = "{:.9g}", end: str = ""
) -> str:
    """Return a header, whose cells are parted by | in each line, over the rows."""
    shown = [[one if isinstance(one, str) else form.format(one) for one in column] for column in (times, X, U)]  # type: ignore[attr-defined]
    if comma:
        shown = [[one.replace(".", ",") for one in column] for column in shown]
    rows = [separator.join(row) for row in zip(*shown, strict=True)]
    return "\n".join([*(line.replace("|", separator) for line in head.splitlines()), *rows]) + f"\n{end}"


def with_comment(text: str) -> str:
    first = text.splitlines()[12]
    return text.replace(first, f"{first}\tstart", 1)


def stamps(form: str) -> list[str]:
    return [(BEGAN + timedelta(seconds=float(one))).strftime(form) for one in TIME]


def since_1970(in_a_second: float) -> list[str]:
    return [f"{(1_709_640_000.0 + one) * in_a_second:.3f}" for one in TIME]


ODD: dict[str, Callable[[], str]] = {
    "a line of units, comma, decimal comma in quotes": lambda: table('"t [s]"|"x [mm]"|"u [V]"', form='"{:.9g}"', comma=True),
    "half days": lambda: table("Time|x [mm]|u [V]", ";", stamps("%m/%d/%Y %I:%M:%S.%f %p")),
    "names of months": lambda: table("Time|x [mm]|u [V]", ";", stamps("%d-%b-%Y %H:%M:%S.%f")),
    "units above the names": lambda: table("s|mm|V\nTime|Position|Voltage"),
    "types below the units": lambda: table("Time|Position|Voltage\n[s]|[mm]|[V]\nDOUBLE|DOUBLE|DOUBLE", ";"),
    "types below the names": lambda: table("Time [s]|Position [mm]|Voltage [V]\nfloat|float64|real", ";"),
    "where it was over names and units": lambda: table("|Rig A|Rig A\nt|x|u\ns|mm|V", ";"),
    "two headers": lambda: table("Clock|Carriage|Amplifier\nTime [s]|Position [mm]|Voltage [V]"),
    "remarks of names and units": lambda: table("% t|x|u\n% s|mm|V", " "),
    "units in brackets between blanks": lambda: table("   t [s]|  x [mm]|  u [V]", "   "),
    "strokes without blanks": lambda: table("t/s|x/mm|u/V", ";", comma=True),
    "words behind the unit": lambda: table("t (s, since start)|Position (mm, from the left)|Voltage (V; AO0)", "\t"),
    "since": lambda: table("Time Stamp (ms since start)|x [mm]|u [V]", ",", 1e3 * TIME),
    "capitals": lambda: table("TIME [S]|X [mm]|U [V]"),
    "words below": lambda: table(BRACKETS, end="End of data\n"),
    "a minus of typesetters": lambda: table(BRACKETS).replace("-", "\u2212"),
    "ms since 1970": lambda: table("timestamp|x [mm]|u [V]", ",", since_1970(1e3)),
    "us since 1970": lambda: table("timestamp|x [mm]|u [V]", ",", since_1970(1e6)),
    "ns since 1970": lambda: table("timestamp|x [mm]|u [V]", ",", since_1970(1e9)),
    "days of a spreadsheet": lambda: table("Time|x [mm]|u [V]", ";", [f"{45356.5 + one / 86400.0:.11f}" for one in TIME]),
    "LabVIEW": lambda: table(LABVIEW, "\t", form="{:.6f}"),
    "LabVIEW with a comment in its first row": lambda: with_comment(table(LABVIEW, "\t", form="{:.6f}", comma=True)),
    "a name more than columns": lambda: table(BRACKETS + "|Comment"),
}  # fmt: skip
LABVIEW = """LabVIEW Measurement|
Separator|Tab
X_Columns|One
Time_Pref|Relative
***End_of_Header***|
|
Channels|2||
Y_Unit_Label|mm|V|
X_Dimension|Time|Time|
X0|0.0|0.0|
***End_of_Header***|||
X_Value|Position|Drive|Comment"""
ENCODED = {"utf-8": b"\xef\xbb\xbf", "utf-16-le": b"\xff\xfe", "utf-16-be": b"\xfe\xff", "cp1252": b""}


def read_as_guessed(code: int = 0) -> dict[str, np.ndarray]:
    assert main(["import", "a.csv", "--map", "new", "--plant", "stage"]) == 0
    assert main(["import", "a.csv", "--map", "a_map.yaml", "--output", "out.mcap"]) == code
    return {} if code else read_log("out.mcap").columns


@pytest.mark.parametrize("case", ODD)
def test_an_odd_table_is_imported_by_the_map_that_its_header_suggests(folder: Path, case: str) -> None:
    Path("a.csv").write_text(ODD[case](), encoding="utf-8")
    columns = read_as_guessed()
    columns["time_s"] = np.round(columns["time_s"], 5)  # a spreadsheet's day has 11 digits
    is_truth(columns)


@pytest.mark.parametrize("encoding", ENCODED)
def test_every_encoding_that_windows_writes_is_read(folder: Path, encoding: str) -> None:
    text = table("Zeit [s]|Weg (geprüft) [mm]|Spannung [V]", "\t", comma=True)
    Path("a.csv").write_bytes(ENCODED[encoding] + text.encode(encoding))
    is_truth(read_as_guessed())


@pytest.mark.parametrize("content", [b"\xff\xfe\x00\x00a\x00", b"\xff\xfet\x00,\x00\x00\x00", b"t,x\0u\n1,2\n", b"\xff\xfe"])
def test_what_is_no_text_is_refused_in_one_line(folder: Path, content: bytes, capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.csv").write_bytes(content)
    assert main(["import", "a.csv", "--map", "new", "--plant", "stage"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not Path("a_map.yaml").exists()


@pytest.mark.parametrize(
    ("label", "name", "unit"),
    [
        ("x/mm", "x", "mm"),
        ("v_m/s", "v", "m/s"),
        ("rate in mm/s", "rate_in", "mm/s"),
        ("m/s", "m/s", ""),
        ("N/mm", "N/mm", ""),
        ("Position (mm, absolute)", "Position", "mm"),
        ("Position (of the carriage)", "Position (of the carriage)", ""),
        ("T1 (degC since noon)", "T1", "degC"),
        ("Left/right", "Left/right", ""),
        ("km/h", "km/h", ""),
        ("F/N", "F", "N"),
        ("TIME [MS]", "TIME", "MS"),
    ],
)
def test_a_unit_is_read_where_it_is_one(label: str, name: str, unit: str) -> None:
    assert unit_in(label) == (name, unit)


def test_times_in_steps_that_may_be_anything_are_asked_for(folder: Path) -> None:
    Path("a.csv").write_text(table("time|x [mm]|u [V]", ",", 1e3 * TIME))
    read_as_guessed(2)
    assert yaml.safe_load(Path("a_map.yaml").read_text())["fields"]["time_s"]["unit"] == "?"


@pytest.mark.parametrize("lacking", [1, 30])
def test_rows_without_a_value_are_asked_for(folder: Path, lacking: int, capsys: pytest.CaptureFixture[str]) -> None:
    lines = table(BRACKETS).splitlines()
    kept = len(lines) - lacking - 5
    lines[kept : kept + lacking] = [line.rpartition(",")[0] + "," for line in lines[kept : kept + lacking]]
    Path("a.csv").write_text("\n".join(lines) + "\n")
    read_as_guessed(2)
    assert "still open: gaps" in capsys.readouterr().err
    text = Path("a_map.yaml").read_text()
    assert f'gaps: "?"  # {lacking} of {len(TIME)} rows lack a value' in text
    Path("a_map.yaml").write_text(text.replace('gaps: "?"', "gaps: interpolate"))
    assert main(["import", "a.csv", "--map", "a_map.yaml", "--output", "out.mcap"]) == 0
    assert len(read_log("out.mcap").columns["time_s"]) == len(TIME)
