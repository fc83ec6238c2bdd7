"""Tables of other people's programs: each is read as it was meant, or refused with the key of the map that helps."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign_truth import ROWS, TIME, U, X, imported, is_truth, mapped

from hjcamp.errors import UsageError

BEGAN = datetime(2024, 2, 29, 23, 59, 58)


def plain(k: int) -> str:
    return f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}"


def text(head: str, row: Callable[[int], str], end: str = "") -> str:
    return "\n".join([head, *(row(k) for k in range(ROWS))]) + "\n" + end


def comma(number: float, digits: int = 3) -> str:
    return f"{number:.{digits}f}".replace(".", ",")


# Numbers that are whole are written without decimals, as many programs do: no comma in the rows where the axis rests.
def bare(number: float) -> str:
    return f"{round(number, 3):g}".replace(".", ",")


TABLES: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "labels from 1": (
        text("1,2,3", plain),
        {"time_s": 1, "position_m": {"column": 2, "unit": "mm"}, "voltage_v": 3},
        {},
    ),
    "labels that are years": (
        text("2019;2020;2021", lambda k: f"{comma(TIME[k])};{comma(X[k], 6)};{comma(U[k])}"),
        {"time_s": 2019, "position_m": {"column": 2020, "unit": "mm"}, "voltage_v": 2021},
        {},
    ),
    "no header": (
        text(f"{TIME[0]:.2f},{X[0]:.6f},{U[0]:.3f}", plain).split("\n", 1)[1],
        {"time_s": 1, "position_m": {"column": 2, "unit": "mm"}, "voltage_v": 3},
        {},
    ),
    "tabs and late commas": (text("t\tx\tu", lambda k: f"{bare(TIME[k])}\t{bare(X[k])}\t{bare(U[k])}"), {}, {}),
    "blanks and late commas": (text("t   x   u", lambda k: f"{bare(TIME[k])}   {bare(X[k])} {bare(U[k])}"), {}, {}),
    "quoted decimals": (
        text('"t","x","u"', lambda k: f'"{comma(TIME[k])}","{comma(X[k], 6)}","{comma(U[k])}"'),
        {},
        {},
    ),
    "names of rows": (text('"t","x","u"', lambda k: f'"{k + 1}",{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}'), {}, {}),
    "names of rows and commas": (text("t;x;u", lambda k: f"row {k};{bare(TIME[k])};{bare(X[k])};{bare(U[k])}"), {}, {}),
    "a comment in some rows": (
        text("t;x;u;note", lambda k: f"{TIME[k]:.2f};{X[k]:.6f};{U[k]:.3f}" + (";moved" if k in (0, 1, 2, 300) else "")),
        {},
        {},
    ),
    "a comment with separators": (
        text("t,x,u,note", lambda k: f'{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f},"a, b, and ""c"""'),
        {},
        {},
    ),
    "inches in rows": (text("t,tube,x,u", lambda k: f'{TIME[k]:.2f},3/4" wide,{X[k]:.6f},{U[k]:.3f}'), {}, {}),
    "doubled quotes": (text('t,"a ""big"" x",u', plain), {"position_m": {"column": 'a "big" x', "unit": "mm"}}, {}),
    "a LabVIEW header": (
        text(
            "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\nX_Value\tx\tu\tComment",
            lambda k: f"{TIME[k]:.6f}\t{X[k]:.6f}\t{U[k]:.6f}",
        ),
        {"time_s": "X_Value"},
        {},
    ),
    "each row twice": (text("t,x,u", lambda k: "\n".join([plain(k)] * 2)), {}, {}),
    "a counter of ms and 16 bits": (
        text("t,x,u", lambda k: f"{(65_000 + 10 * k) % 65_536},{X[k]:.6f},{U[k]:.3f}"),
        {"time_s": {"column": "t", "unit": "ms", "unwrap": 65536}},
        {},
    ),
    "a counter of us and 32 bits": (
        text("t,x,u", lambda k: f"{(4294000000 + 10_000 * k) % 2**32},{X[k]:.6f},{U[k]:.3f}"),
        {"time_s": {"column": "t", "unit": "us", "unwrap": 2**32}},
        {},
    ),
    "seconds of the day": (
        text("t,x,u", lambda k: f"{(86_398.5 + TIME[k]) % 86_400:.2f},{X[k]:.6f},{U[k]:.3f}"),
        {"time_s": {"column": "t", "unwrap": 86400}},
        {},
    ),
    "days of a spreadsheet": (
        text("t,x,u", lambda k: f"{45356.999 + TIME[k] / 86400:.12f},{X[k]:.6f},{U[k]:.3f}"),
        {"time_s": {"column": "t", "unit": "day"}},
        {},
    ),
    "a counter of rows": (
        text("t,x,u", lambda k: f"{(200 + k) % 256},{X[k]:.6f},{U[k]:.3f}"),
        {"time_s": {"column": "t", "scale": 0.01, "unwrap": 256}},
        {},
    ),
    "an encoder of 14 bits": (
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{(16380 + round(1e3 * X[k])) % 16384},{U[k]:.3f}"),
        {"position_m": {"column": "x", "scale": 1e-3, "unit": "mm", "unwrap": 16384, "offset": -16.380}},
        {},
    ),
}


@pytest.mark.parametrize("case", TABLES)
def test_a_table_is_read_as_the_whole_of_it_is_written(folder: Path, case: str) -> None:
    written, fields, more = TABLES[case]
    Path("table.csv").write_text(written)
    is_truth(imported(Path("table.csv"), mapped(fields, **more))[1])


REFUSED: dict[str, tuple[str, dict[str, Any], dict[str, Any], str]] = {
    "labels or a row": (
        text("0,1,2", lambda k: f"{10 * k},{round(1e3 * X[k])},{round(1e3 * U[k])}"),
        {"time_s": {"column": 1, "unit": "ms"}, "position_m": {"column": 2, "unit": "um"}, "voltage_v": 3},
        {},
        "say in the map header: true or header: false",
    ),
    "commas beside points": (
        text("t;x;u", lambda k: f"{TIME[k]:.2f};{comma(X[k])};{U[k]:.3f}"),
        {},
        {},
        "'x' is no number in row 1: '0,000'; .*decimal_comma: true",
    ),
    "a word for no reading": (
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{'---' if 100 < k < 110 else X[k]},{U[k]:.3f}"),
        {},
        {},
        r"missing: \['---'\]",
    ),
    "a number for no reading": (
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{-9999 if 100 < k < 110 else X[k]},{U[k]:.3f}"),
        {},
        {"missing": [-9999]},
        "'position_m' is nan .* gaps: interpolate",
    ),
    "missing that is nothing": (
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{X[k]},{U[k]:.3f}"),
        {},
        {"missing": []},
        "give what stands for no reading",
    ),
    "two tests in one table": (
        text("t,x,u", lambda k: f"{TIME[k % 300]:.2f},{X[k]:.6f},{U[k]:.3f}"),
        {},
        {},
        "time does not increase at row 301.*tables of their own",
    ),
    "ms that begin again": (
        text("t,x,u", lambda k: f"{(65_000 + 10 * k) % 65_536},{X[k]:.6f},{U[k]:.3f}"),
        {"time_s": {"column": "t", "unit": "ms"}},
        {},
        "unwrap: 65536",
    ),
    "midnight in seconds": (
        text("t,x,u", lambda k: f"{(86_398.5 + TIME[k]) % 86_400:.2f},{X[k]:.6f},{U[k]:.3f}"),
        {},
        {},
        "unwrap: 86400",
    ),
    "days taken for seconds": (
        text("t,x,u", lambda k: f"{45356.5 + TIME[k] / 86400:.12f},{X[k]:.6f},{U[k]:.3f}"),
        {},
        {},
        "days of a spreadsheet: unit: day",
    ),
    "stamps of a tenth": (
        text("t,x,u", lambda k: f"{TIME[k]:.1f},{X[k]:.6f},{U[k]:.3f}"),
        {},
        {},
        "stamps are coarser than rows; give period_s",
    ),
    "hours or minutes": (
        text("t,x,u", lambda k: f"09:{k // 60:02d},{X[k]:.6f},{U[k]:.3f}"),
        {},
        {},
        "may be hours and minutes, or minutes and seconds",
    ),
    "a colon and two digits": (
        text("t,x,u", lambda k: f"00:09:{k // 100:02d}:{k % 100:02d},{X[k]:.6f},{U[k]:.3f}"),
        {},
        {},
        "can be read in several ways",
    ),
    "unwrap by nothing": (
        text("t,x,u", lambda k: f"{TIME[k]},{X[k]:.6f},{U[k]:.3f}"),
        {"position_m": {"column": "x", "unwrap": 0}},
        {},
        "unwrap is 0",
    ),
    "a key that nobody knows": (
        text("t,x,u", lambda k: f"{TIME[k]},{X[k]:.6f},{U[k]:.3f}"),
        {"position_m": {"column": "x", "unwarp": 360}},
        {},
        "did you mean 'unwrap'",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_table_that_can_be_read_in_two_ways_is_refused_with_the_key(folder: Path, case: str) -> None:
    written, fields, more, said = REFUSED[case]
    Path("table.csv").write_text(written)
    with pytest.raises(UsageError, match=said) as refusal:
        imported(Path("table.csv"), mapped(fields, **more))
    assert "\n" not in str(refusal.value) and not Path("out.mcap").exists()


def test_a_header_that_is_said_is_taken(folder: Path) -> None:
    rows = text("0,1,2", lambda k: f"{10 * (k + 1)},{round(1e6 * X[k])},{round(1e3 * U[k])}")
    Path("table.csv").write_text(rows)
    fields = {
        "time_s": {"column": 0, "unit": "ms"},
        "position_m": {"column": 1, "scale": 1e-6, "unit": "mm"},
        "voltage_v": {"column": 2, "scale": 1e-3},
    }
    is_truth(imported(Path("table.csv"), mapped(fields, header=True))[1])


STAMPS: dict[str, Callable[[timedelta], str]] = {
    "a comma before ms": lambda past: (BEGAN + past).strftime("%Y-%m-%d %H:%M:%S,%f")[:-3],
    "a colon before us": lambda past: (BEGAN + past).strftime("%H:%M:%S:%f"),
    "a month by name": lambda past: (BEGAN + past).strftime("%d-%b-%Y %H:%M:%S.%f"),
    "a month first": lambda past: (BEGAN + past).strftime("%b %d, %Y %I:%M:%S.%f %p"),
    "a German month": lambda past: (
        (BEGAN + past).strftime("%d. März 2024 %H:%M:%S,%f").replace("29. März", "31. März").replace("01. März", "01. April")
    ),
    "a German date": lambda past: (BEGAN + past).strftime("%d.%m.%Y %H:%M:%S,%f"),
    "a short year": lambda past: (BEGAN + past).strftime("%d.%m.%y %H:%M:%S.%f"),
    "as C writes it": lambda past: (BEGAN + past).strftime("%a %b %d %H:%M:%S.%f %Y"),
    "the day behind the time": lambda past: (BEGAN + past).strftime("%H:%M:%S.%f %d/%m/%Y"),
    "with a zone": lambda past: (BEGAN + past).strftime("%Y-%m-%dT%H:%M:%S.%f+01:00"),
    "out of summer time": lambda past: (
        datetime(2024, 10, 27, 2, 59, 58) + past - timedelta(hours=past.total_seconds() >= 2)
    ).strftime(f"%Y-%m-%dT%H:%M:%S.%f+0{1 if past.total_seconds() >= 2 else 2}:00"),
    "of a camera": lambda past: (BEGAN + past).strftime("%Y:%m:%d %H:%M:%S.%f"),
    "in one piece": lambda past: (BEGAN + past).strftime("%Y%m%d %H:%M:%S.%f"),
    "of a day": lambda past: (BEGAN + past).strftime("%H:%M:%S.%f"),
    "behind noon": lambda past: (datetime(2024, 3, 5, 11, 59, 58) + past).strftime("%I:%M:%S.%f %p"),
    "over 24 hours": lambda past: f"{30 + int(past.total_seconds()) // 3600}:00:{past.total_seconds():06.3f}",
    "minutes over the hour": lambda past: (datetime(2024, 3, 5, 9, 59, 58) + past).strftime("%M:%S.%f"),
    "days and hours": lambda past: f"3 days {(datetime(2024, 3, 5) + past).strftime('%H:%M:%S.%f')}",
}


@pytest.mark.parametrize(("row", "cell"), [(0, "09:59:"), (300, "09:5x:58.0"), (599, "")])
def test_the_row_that_is_no_time_is_named(folder: Path, row: int, cell: str) -> None:
    stamp = STAMPS["of a day"]
    rows = text("t;x;u", lambda k: f"{cell if k == row else stamp(timedelta(milliseconds=10 * k))};{X[k]:.6f};{U[k]:.3f}")
    Path("table.csv").write_text(rows)
    with pytest.raises(UsageError, match=f"'t' is no time in row {row + 1}: '{cell}'"):
        imported(Path("table.csv"), mapped())


@pytest.mark.parametrize("case", STAMPS)
def test_a_time_is_read_as_people_write_it(folder: Path, case: str) -> None:
    stamp = STAMPS[case]
    Path("table.csv").write_text(text("t;x;u", lambda k: f"{stamp(timedelta(milliseconds=10 * k))};{X[k]:.6f};{U[k]:.3f}"))
    is_truth(imported(Path("table.csv"), mapped())[1])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("share", [0.005, 0.02, 0.1])
def test_lost_rows_are_refused_or_filled_in_at_the_period_of_the_others(folder: Path, share: float, seed: int) -> None:
    generator = np.random.default_rng(seed)
    kept = np.flatnonzero(generator.random(ROWS) > share)
    kept = np.union1d(kept, [0, *range(1, ROWS, 3), ROWS - 1])
    rows = [plain(k) for k in kept]
    Path("table.csv").write_text("\n".join(["t,x,u", *rows]) + "\n")
    lost = ROWS - len(kept)
    with pytest.raises(UsageError, match=f"{lost} rows? (is|are) lost of {ROWS}, .*gaps: interpolate"):
        imported(Path("table.csv"), mapped())
    one, columns = imported(Path("table.csv"), mapped(gaps="interpolate"))
    assert any(f"lost of {ROWS}" in finding.line for finding in one.doubtful)
    assert len(columns["time_s"]) == ROWS and np.abs(1e3 * columns["position_m"] - X).max() < 2.0 * np.abs(np.diff(X)).max()
    np.testing.assert_allclose(columns["voltage_v"][kept], U[kept])


@pytest.mark.parametrize(
    ("none", "said"),
    [("-9999", [-9999]), ("65535", [65535]), ("1e30", ["1e30"]), ("---", ["---"]), ("OVLD", ["OVLD", -999])],
)
def test_what_stands_for_no_reading_is_left_out(folder: Path, none: str, said: list[Any]) -> None:
    Path("table.csv").write_text(
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{none if 200 <= k < 205 or k == 0 else X[k]},{U[k]:.3f}")
    )
    one, columns = imported(Path("table.csv"), mapped(missing=said, gaps="interpolate"))
    assert any("'position_m' has no value in 6 rows of 600, at most 5 in a row" in finding.line for finding in one.doubtful)
    good = np.delete(np.arange(ROWS), [0, *range(200, 205)])
    np.testing.assert_allclose(1e3 * columns["position_m"][good], X[good], atol=1e-9)


@pytest.mark.parametrize(
    ("voltage", "motion", "told"),
    [
        (0.0, X, True),
        (2.5, X, True),
        # under a constant voltage it reaches a constant speed; what comes to rest is not driven
        (2.5, 20.0 * (TIME - 0.3 * (1.0 - np.exp(-TIME / 0.3))), False),
        (0.0, 20.0 * np.exp(-TIME) * np.cos(9.0 * TIME), False),
        (0.0, np.random.default_rng(1).normal(0.0, 0.01, ROWS), False),
        (None, X, False),
    ],
)
def test_an_input_that_never_changes_is_doubted_where_something_drives(
    folder: Path, voltage: float | None, motion: np.ndarray, told: bool
) -> None:
    Path("table.csv").write_text(
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{motion[k]:.6f},{U[k] if voltage is None else voltage:.3f}")
    )
    one, _ = imported(Path("table.csv"), mapped())
    found = [finding.line for finding in one.doubtful if finding.field == "voltage_v"]
    assert any("in all 600 samples although 'position_m' moves to the end" in line for line in found) == told


@pytest.mark.parametrize(
    "line",
    [
        "{column: x [mm], unit: mm}",
        "{column: a: b, unit: mm}",
        "{column: {x}, unit: mm, x: [}",
        '{column: 3/4" "x, unit: mm',
        "[x",
        "a: b: c",
        '"x" [mm]',
        "@x",
        "%x",
        "`x`",
        "*x",
        "{column: [x], unit: mm}",
    ],
)
def test_a_name_that_yaml_reads_otherwise_is_to_be_quoted(folder: Path, line: str) -> None:
    Path("map.yaml").write_text(f"plant: stage\nfields:\n  time_s: t\n  position_m: {line}\n  voltage_v: u\n")
    with pytest.raises(UsageError, match="in quotes"):
        imported(Path("table.csv"), Path("map.yaml"))
