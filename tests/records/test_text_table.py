"""What separates the columns of a file, and whether it has decimal commas, is read off the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from hjcamp.records.elsewhere.text_table import Dialect, dialect_of


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("t,u,y\n0.0,1.5,2\n0.1,1.5,3\n", (",", False, None)),
        ("t;u;y\n0,0;1,5;2\n0,1;1,5;3\n", (";", True, None)),
        ("t;u;y\n0.0;1.5;2\n", (";", False, None)),
        ("t\tu, V\ty\n0.0\t1,5\t2\n", ("\t", False, None)),
        ("t\tu\n0,5\t-1,5\n", ("\t", True, None)),
        ("t;u\n1;2\n", (";", False, None)),
        ("q(1,2);y\n1;2\n", (";", False, None)),
        ("t\n1\n2\n", (",", False, None)),
        ("", (",", False, None)),
        ("# made by hand\n# twice\nt;u\n0,5;1\n", (";", True, "#")),
        ("% rig 3\nt,u\n0.5,1\n", (",", False, "%")),
        ("# t,u\n0.5,1\n", (",", False, None)),
        ("  t    u\n 0.5   1\n10.5  -1\n", (" ", False, None)),
        (" 0.5   1\n10.5  -1e3\n", (" ", False, None, False)),
        ("0,5;1\n1,5;2\n", (";", True, None, False)),
        ("0.5,1\n1.5,nan\n", (",", False, None, False)),
    ],
)
def test_a_separator_stands_equally_often_in_each_row(tmp_path: Path, text: str, found: tuple[Any, ...]) -> None:
    (tmp_path / "x.csv").write_text(text, encoding="utf-8")
    assert dialect_of(tmp_path / "x.csv") == Dialect(*found)


def test_lines_before_the_header_and_comments_are_passed_over(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("made, by, hand\n# a, b\nt;u\n0,5;1,5\n", encoding="utf-8")
    assert dialect_of(tmp_path / "x.csv", skip_lines=1, comment="#") == Dialect(";", True, "#")
