"""What separates the columns of a file, and whether it has decimal commas, is read off the file."""

from __future__ import annotations

from typing import Any

import pytest

from hjcamp.records.elsewhere.text_table import Dialect, dialect_of, table_of


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
def test_a_separator_stands_equally_often_in_each_row(text: str, found: tuple[Any, ...]) -> None:
    assert dialect_of(text.split("\n")) == Dialect(*found)


def test_lines_before_the_header_and_comments_are_passed_over() -> None:
    assert dialect_of(["# a, b", "t;u", "0,5;1,5", ""], comment="#") == Dialect(";", True, "#")


@pytest.mark.parametrize(
    ("lines", "names", "table"),
    [
        # what stands before the header that has all names is no row; nor is an empty line
        (["Logger 3, by me", "", '"t","u"', "0,1", "1,2", ""], ("u", "t"), ['"t","u"', "0,1", "1,2"]),
        (["Channels: 2", "t   u", "0   1"], ("t", "u"), ["t   u", "0   1"]),
        # a header that is not there is told from the first line
        (["t,u", "0,1"], ("t", "v"), ["t,u", "0,1"]),
        # columns by number have no header
        (["0,5", "1,2", "3,4"], ("1", "2"), ["0,5", "1,2", "3,4"]),
        # a separator at each row's end, also where the last is cut off
        (["t;u", "0;1;", "1;2;", "2;3;"], ("t", "u"), ["t;u", "0;1", "1;2", "2;3"]),
        (["t;u", "0;1;", "1;2;", "2"], ("t", "u"), ["t;u", "0;1", "1;2", "2"]),
        (["t;u;", "0;1;", "1;2;"], ("t", "u"), ["t;u;", "0;1;", "1;2;"]),
        # rows without any value at the end, as a spreadsheet leaves them; one between others stays, and is refused
        (["t,u", "0,1", "1,2", ",", '"",'], ("t", "u"), ["t,u", "0,1", "1,2"]),
        (["t,u", "0,1", ",", "1,2"], ("t", "u"), ["t,u", "0,1", ",", "1,2"]),
        (["t;u", "0;1;", "1;2", "2;3;"], ("t", "u"), ["t;u", "0;1;", "1;2", "2;3;"]),
    ],
)
def test_a_table_begins_at_its_header(lines: list[str], names: tuple[str, ...], table: list[str]) -> None:
    assert table_of(lines, names) == table
