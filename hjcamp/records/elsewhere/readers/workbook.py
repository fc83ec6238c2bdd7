"""Workbooks of spreadsheets: a sheet is read as a table of text is, with what stands above its header."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from hjcamp.records.elsewhere.cells import numbers_of
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.reader import (
    Column,
    Reader,
    Table,
    check_archive,
    check_width,
    damage_as_refusal,
    one_of,
)
from hjcamp.records.elsewhere.text_head import head_of
from hjcamp.records.elsewhere.text_table import table_of

if TYPE_CHECKING:
    import polars

ZIPPED = (".xlsx", ".xlsm", ".xlsb", ".ods")


class Workbook(Reader):
    endings = (*ZIPPED, ".xls")
    says = "a workbook"
    extra = "xlsx"
    packages = ("fastexcel",)

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named columns of the map's ``sheet``."""
        import polars

        sheet = self._sheet(source, rules.sheet)
        texts = self._cells(source, sheet, "string")
        check_width(source, texts.width)
        lines = _lines(texts)
        header = rules.header is not False
        first = rules.skip_lines
        if header:
            first += lines[first:].index(table_of(lines[first:], names, rules.comment)[0])
        body = first + header + rules.units_below
        # a cell as a text has nine digits
        numbers = self._cells(source, sheet, "float", skip_rows=body)
        kept = []
        for place, name in enumerate(texts.columns):
            text = texts[name][body:]
            number = numbers[:, place] if place < numbers.width else polars.Series([], dtype=polars.Float64)
            number = number.extend_constant(None, len(text) - len(number)) if len(number) < len(text) else number[: len(text)]
            called = (texts[name][first] or "") if header else str(place + 1)
            kept.append((called, polars.select(polars.coalesce(number.cast(polars.String), text)).to_series()))
        return Table(numbers_of(source, polars.DataFrame([one.alias(called) for called, one in kept]), names, False, rules))

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the names of the headers of all sheets, or of the map's."""
        sheets = [self._sheet(source, rules.sheet)] if rules.sheet else self._sheets(source)
        found = []
        for sheet in sheets:
            key = ("sheet", sheet) if len(self._sheets(source)) > 1 else None
            found += [replace(one, key=key) for one in head_of(_lines(self._cells(source, sheet, "string")), "\t").columns]
        return found

    def keys(self, source: Path, rules: ImportMap) -> dict[str, object]:
        """Return the keys that lead below the lines before the rows of the map's sheet, or the first one."""
        sheet = rules.sheet or self._sheets(source)[0]
        return head_of(_lines(self._cells(source, sheet, "string")), "\t").keys

    def _sheets(self, source: Path) -> list[str]:
        import fastexcel

        if source.suffix.casefold() in ZIPPED:
            check_archive(source, self.says)
        with damage_as_refusal(source, self.says):
            return list(fastexcel.read_excel(source).sheet_names)

    def _sheet(self, source: Path, given: str) -> str:
        return one_of("sheet", given, self._sheets(source), source)

    def _cells(self, source: Path, sheet: str, kind: Literal["string", "float"], skip_rows: int = 0) -> polars.DataFrame:
        import fastexcel

        with damage_as_refusal(source, self.says):
            found = fastexcel.read_excel(source).load_sheet(sheet, header_row=None, skip_rows=skip_rows, dtypes=kind)
            return found.to_polars()


def _lines(texts: polars.DataFrame) -> list[str]:
    """Return rows of texts as lines with tabs between cells."""
    import polars

    if not texts.width:
        return []
    cells = polars.all().cast(polars.String).fill_null("").str.replace_all(r"[\t\r\n]", " ")
    return texts.select(polars.concat_str(cells, separator="\t").alias("line"))["line"].to_list()
