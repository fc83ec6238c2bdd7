"""The end of a run in the terminal: every condition beside its published values."""

from __future__ import annotations

import polars as pl
from rich.table import Table
from rich.text import Text

from hjcamp.report.sheet import Sheet, arrange_conditions
from hjcamp.report.tables import by_condition

STYLES = {"key": "", "value": "", "published": "dim", "block": "bold"}


def summary_table(indicators: pl.DataFrame) -> Table:
    """Return a rich table of the conditions: the choices that vary, each indicator, and the published values beside.

    ▲ and ▼ mark means that are more than two published standard deviations above or below.
    """
    return terminal_table(arrange_conditions(by_condition(indicators)))


def terminal_table(sheet: Sheet) -> Table:
    """Return any sheet as a rich table."""
    table = Table(box=None, pad_edge=False, header_style="bold", caption_justify="left", caption_style="dim")
    for header in sheet.headers:
        table.add_column(header, style="dim" if header == "published" else "", no_wrap=True)
    for row in sheet.rows:
        table.add_row(*[_text(cell.text, cell.kind, cell.mark) for cell in row])
    table.caption = Text("\n".join(sheet.notes))
    return table


def _text(text: str, kind: str, mark: str) -> Text:
    # Text, not markup: a condition named "[red]" must show as it is.
    shown = Text(text, style=STYLES[kind])
    return shown.append(f" {mark}", style="bold red") if mark else shown
