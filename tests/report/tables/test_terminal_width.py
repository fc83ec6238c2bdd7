"""The tables of the terminal are whole in narrow ones."""

from __future__ import annotations

import io
import re

import pytest
from report_samples import make_log
from rich.cells import cell_len
from rich.console import Console

from hjcamp.plants.pump_joint.published.values import measured_indicators
from hjcamp.records.log import TestLog
from hjcamp.report.runs.varied import indicators_frame
from hjcamp.report.tables.aggregation import build_table, by_condition
from hjcamp.report.tables.declared import declared_tables
from hjcamp.report.tables.sheet import Sheet, arrange, arrange_conditions
from hjcamp.report.tables.terminal import FittedSheet, summary_table

WIDTHS = (80, 100)


def printed(what: object, width: int) -> str:
    console = Console(file=io.StringIO(), width=width, force_terminal=True, color_system=None, soft_wrap=True)
    console.print(what)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def campaign(error_deg: float = 12.34) -> list[TestLog]:
    """Return the conditions of the demo, far off the published values."""
    return [
        make_log(trajectory, controller, number, error_deg, payload="brass_8p5g", orientation="vertical")
        for trajectory in ("sine_0p5hz", "cycloid_pos", "cycloid_neg")
        for controller in ("pid", "ffwd_pid")
        for number in (1, 2, 3)
    ]


def assert_whole(text: str, sheet: Sheet, width: int) -> None:
    lines = text.splitlines()
    assert max(cell_len(line.rstrip()) for line in lines) <= width
    assert "…" not in text and "..." not in text
    for place, header in enumerate(sheet.headers):
        cells = [row[place] for row in sheet.rows if len(row) == len(sheet.headers)]
        if header == "n" and len({cell.text for cell in cells}) == 1:
            continue
        for cell in cells:
            shown = f"{cell.text} {cell.mark}".strip()
            assert text.count(shown) >= sum(one == cell for one in cells), shown


@pytest.mark.parametrize("width", WIDTHS)
def test_the_table_that_ends_a_run_is_whole(width: int) -> None:
    frame = indicators_frame(campaign())
    sheet = arrange_conditions(by_condition(frame))
    text = printed(summary_table(frame), width)
    assert_whole(text, sheet, width)
    assert text.count("▲") >= sum(bool(cell.mark) for row in sheet.rows for cell in row) == 22
    assert re.search(r"cycloid_pos +ffwd_pid +12\.54 ± 0\.10 ▲ +0\.8 ± 0\.10", text)
    assert "n = 3 in every row." in text


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", [definition.name for definition in declared_tables()])
def test_every_declared_table_is_whole(name: str, width: int) -> None:
    (definition,) = declared_tables([name])
    table = build_table(measured_indicators(), definition, "published")
    sheet = arrange(table, definition)
    if table.height:
        assert_whole(printed(FittedSheet(sheet), width), sheet, width)


@pytest.mark.parametrize("width", WIDTHS)
def test_a_long_name_is_folded_and_no_number_is_lost(width: int) -> None:
    long = "a_case_with_a_name_that_is_longer_than_any_terminal_that_a_person_would_still_read__" * 2
    logs = [make_log("ramp_pos", "pid", 1, 12.3, condition=long + end) for end in ("one", "two")]
    text = printed(summary_table(indicators_frame(logs)), width)
    assert max(cell_len(line.rstrip()) for line in text.splitlines()) <= width
    assert text.count("12.40 ▲") == 6 and "…" not in text
    # The folded pieces of a name stand first in their lines; together they are the name.
    pieces = "".join(line.split()[0] for line in text.splitlines() if line.strip())
    assert long + "one" in pieces and long + "two" in pieces


def test_a_wide_terminal_has_one_block_with_the_number_of_tests() -> None:
    text = printed(summary_table(indicators_frame(campaign())), 160)
    assert re.search(r"cycloid_pos +ffwd_pid +3 +12\.54 ± 0\.10 ▲", text)
    assert text.count("trajectory") == 1
