"""A large table is read in pieces as it is read as a whole, or as a whole where a piece cannot say what it holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign_truth import ROWS, TIME, U, X, mapped
from test_foreign_tables import REFUSED, TABLES, text

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere import text_pieces
from hjcamp.records.elsewhere.import_map import read_import_map
from hjcamp.records.elsewhere.tables import read_table
from hjcamp.records.elsewhere.text_pieces import numbers_in_pieces

PLAIN = {
    "commas": (text("t,x,u", lambda k: f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}"), {}),
    "lines of Windows": (text("t,x,u\r", lambda k: f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}\r"), {}),
    "no last line end": (text("t,x,u", lambda k: f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}").rstrip("\n"), {}),
    "decimal commas": (text("t;x;u", lambda k: f"{TIME[k]:.2f};{X[k]:.6f};{U[k]:.3f}".replace(".", ",")), {}),
    "blanks": (text("  t   x   u", lambda k: f" {TIME[k]:.2f}   {X[k]:.6f} {U[k]:.3f} "), {}),
    "tabs and empty lines": (text("\n\nt\tx\tu\n", lambda k: f"{TIME[k]:.2f}\t{X[k]:.6f}\t{U[k]:.3f}\n"), {}),
    "other columns, another order": (text("note,u,t,x", lambda k: f"ok {k},{U[k]:.3f},{TIME[k]:.2f},{X[k]:.6f}"), {}),
    "lines above": (text("Logger 3\nby me\nt,x,u", lambda k: f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}"), {"skip_lines": 1}),
    "units below": (text("t,x,u\ns,mm,V", lambda k: f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}"), {"units_below": True}),
    "remarks": (text("# a\n# b\nt,x,u", lambda k: f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}\n# {k}"), {"comment": "#"}),
    "gaps": (
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{'' if k % 50 == 7 else X[k]},{'---' if k == 9 else U[k]}"),
        {"gaps": "interpolate", "missing": ["---"]},
    ),
    "empty rows at the end": (
        text("t,x,u", lambda k: f"{TIME[k]:.2f},{X[k]:.6f},{U[k]:.3f}", ",,\n,,\n"),
        {"gaps": "interpolate"},
    ),
}


def as_read(rules: Any, piece: int, monkeypatch: pytest.MonkeyPatch) -> dict[str, np.ndarray] | str:
    monkeypatch.setattr(text_pieces, "PIECE", piece)
    try:
        return read_table(Path("table.csv"), rules).columns
    except UsageError as refusal:
        return str(refusal)


@pytest.mark.parametrize("size", [1000, 4096, 9000])
@pytest.mark.parametrize("case", PLAIN)
def test_plain_numbers_are_read_in_pieces(folder: Path, monkeypatch: pytest.MonkeyPatch, case: str, size: int) -> None:
    written, more = PLAIN[case]
    Path("table.csv").write_bytes(written.encode())
    rules = read_import_map(mapped({}, **more))
    whole = as_read(rules, 10**9, monkeypatch)
    monkeypatch.setattr(text_pieces, "PIECE", size)
    pieces = numbers_in_pieces(Path("table.csv"), ["t", "x", "u"], rules)
    assert pieces is not None and isinstance(whole, dict) and len(pieces["t"]) == ROWS
    for name, values in whole.items():
        np.testing.assert_array_equal(pieces[name], values)


@pytest.mark.parametrize("case", [*TABLES, *REFUSED])
def test_every_other_table_is_read_or_refused_as_a_whole_one(folder: Path, monkeypatch: pytest.MonkeyPatch, case: str) -> None:
    written, fields, more, *_ = TABLES.get(case) or REFUSED[case]
    Path("table.csv").write_text(written)
    try:
        rules = read_import_map(mapped(fields, **more))
    except UsageError:
        return  # the map itself is refused, whatever the file is
    whole, pieces = as_read(rules, 10**9, monkeypatch), as_read(rules, 2000, monkeypatch)
    assert isinstance(pieces, str) == isinstance(whole, str)
    if isinstance(whole, str) or isinstance(pieces, str):
        assert pieces == whole
        return
    for name, values in whole.items():
        np.testing.assert_array_equal(pieces[name], values)


@pytest.mark.parametrize("row", [0, 300, 599])
@pytest.mark.parametrize("cell", ["", "abc", '"1"', "12:00:01", "1,5"])
def test_a_cell_that_is_no_number_is_said_with_its_row_in_the_file(
    folder: Path, monkeypatch: pytest.MonkeyPatch, row: int, cell: str
) -> None:
    written = text("t;x;u", lambda k: f"{TIME[k]:.2f};{cell if k == row else X[k]};{U[k]:.3f}")
    Path("table.csv").write_text(written)
    rules = read_import_map(mapped())
    whole, pieces = as_read(rules, 10**9, monkeypatch), as_read(rules, 2000, monkeypatch)
    assert str(whole) == str(pieces)
