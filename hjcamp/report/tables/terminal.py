"""Sheets in the terminal: whole at any width, in several blocks of columns where one is too wide."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import polars as pl
from rich.cells import cell_len
from rich.table import Table
from rich.text import Text

from hjcamp.errors import visible
from hjcamp.report.tables.aggregation import by_condition
from hjcamp.report.tables.sheet import REFERENCE_COLUMNS, Cell, Sheet, arrange_conditions

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType

STYLES = {"key": "", "value": "", "published": "dim", "block": "bold"}
GAP = 2


def summary_table(indicators: pl.DataFrame, against: str | None = "published") -> FittedSheet:
    """Return the conditions for the terminal: the choices that vary, each indicator, and the published values next to them.

    ▲ and ▼ mark means that are more than two published standard deviations above or below.
    """
    return FittedSheet(arrange_conditions(by_condition(indicators, against)))


def refitted_table(sheet: Sheet) -> FittedSheet:
    """Return the first indicator of `against_refit` in three columns, as printed, refitted and measured."""
    headers = [sheet.headers[0], f"{sheet.headers[1]} as printed", "refitted", "measured"]
    return FittedSheet(Sheet(sheet.name, sheet.title, "", headers, [row[:4] for row in sheet.rows], []))


@dataclass(frozen=True)
class FittedSheet:
    """A sheet that rich prints into the width there is: columns that do not fit follow below, behind the keys again."""

    sheet: Sheet

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[RenderableType]:
        """Yield the blocks of columns, then the notes; nothing is cut."""
        notes = self.sheet.notes
        blocks = [list(range(len(self.sheet.headers)))]
        if self._width(blocks[0]) > options.max_width:
            keys, same = self._keys()
            notes = [f"n = {same} in every row.", *notes] if same else notes
            blocks = self._packed(keys, options.max_width)
        for number, columns in enumerate(blocks):
            if number:
                yield Text("")
            yield self._table(columns)
        for note in notes:
            yield Text(note, style="dim", no_wrap=False, overflow="fold")

    def _keys(self) -> tuple[list[int], str]:
        """Return the columns that stand in every block; a number of tests that is the same everywhere is said once."""
        rows = self._rows()
        keys = [place for place, cell in enumerate(rows[0] if rows else []) if cell.kind == "key"]
        if "n" not in self.sheet.headers:
            return keys, ""
        place = self.sheet.headers.index("n")
        numbers = {row[place].text for row in rows}
        return (keys, numbers.pop()) if len(numbers) == 1 else ([*keys, place], "")

    def _packed(self, keys: list[int], width: int) -> list[list[int]]:
        """Return the columns of each block: as many as fit, and a published value always next to its mean."""
        headers = self.sheet.headers
        left = [place for place in range(len(headers)) if place not in keys and headers[place] != "n"]
        pairs: list[list[int]] = []
        for place in left:
            if headers[place] in REFERENCE_COLUMNS and pairs:
                pairs[-1].append(place)
            else:
                pairs.append([place])
        blocks: list[list[int]] = []
        for pair in pairs:
            if blocks and self._width([*blocks[-1], *pair]) <= width:
                blocks[-1] += pair
            else:
                blocks.append([*keys, *pair])
        return blocks or [keys]

    def _table(self, columns: Sequence[int]) -> Table:
        table = Table(box=None, pad_edge=False, header_style="bold")
        keys = {place for row in self._rows()[:1] for place, cell in enumerate(row) if cell.kind == "key"}
        for place in columns:
            header = self.sheet.headers[place]
            # Where nothing else helps a long name is folded; a number or its mark never is.
            table.add_column(
                header, style="dim" if header in REFERENCE_COLUMNS else "", no_wrap=place not in keys, overflow="fold"
            )
        for row in self.sheet.rows:
            table.add_row(*[_text(row[place]) for place in columns if place < len(row)])
        return table

    def _rows(self) -> list[list[Cell]]:
        return [row for row in self.sheet.rows if len(row) == len(self.sheet.headers)]

    def _width(self, columns: Sequence[int]) -> int:
        widths = [
            max(cell_len(text) for text in (self.sheet.headers[place], *(_shown(row[place]) for row in self._rows())))
            for place in columns
        ]
        return sum(widths) + GAP * (len(widths) - 1)


def _shown(cell: Cell) -> str:
    return visible(f"{cell.text} {cell.mark}".rstrip())


def _text(cell: Cell) -> Text:
    # Text, not markup: a condition named "[red]" must show as it is.
    shown = Text(visible(cell.text), style=STYLES[cell.kind])
    return shown.append(f" {cell.mark}", style="bold red") if cell.mark else shown
