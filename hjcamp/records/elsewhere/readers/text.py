"""Tables of text: CSV and its relatives, in any encoding, with any separator, under any preamble."""

from __future__ import annotations

import codecs
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.cells import numbers_of
from hjcamp.records.elsewhere.import_map import ImportMap
from hjcamp.records.elsewhere.reader import MOST_COLUMNS, Column, Reader, Table, check_width, first_line
from hjcamp.records.elsewhere.readers import endings
from hjcamp.records.elsewhere.text_head import head_of
from hjcamp.records.elsewhere.text_pieces import numbers_in_pieces
from hjcamp.records.elsewhere.text_table import BLANKS, dialect_of, most_cells, table_of, with_whole_quotes

if TYPE_CHECKING:
    import polars

LOOKED_AT = 4096
MINUS = "\N{MINUS SIGN}"  # as typesetting programs write it


class Text(Reader):
    endings = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm")
    says = "a table of text"

    def read(self, source: Path, names: list[str], rules: ImportMap) -> Table:
        """Return the named columns."""
        if (found := numbers_in_pieces(source, names, rules)) is not None:
            return Table(found)
        table, comma = table_of_lines(source, lines_of_text(source)[rules.skip_lines :], names, rules)
        return Table(numbers_of(source, table, names, comma, rules))

    def columns(self, source: Path, rules: ImportMap) -> list[Column]:
        """Return the names of the header, or the numbers of the columns, with the units below or within."""
        return head_of(lines_of_text(source)[rules.skip_lines :]).columns

    def keys(self, source: Path, rules: ImportMap) -> dict[str, object]:
        """Return the keys that lead below the lines before the rows."""
        return head_of(lines_of_text(source)[rules.skip_lines :]).keys


def lines_of_text(source: Path) -> list[str]:
    """Return the lines of a file: UTF-8, UTF-16 with its mark, else cp1252, as Windows writes it."""
    with source.open("rb") as stream:
        begin = stream.read(LOOKED_AT)
    wide = begin.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) and "\0" not in begin.decode("utf-16", "replace")
    if b"\0" in begin and not wide:
        listed = ", ".join(one for one in endings() if one not in Text.endings)
        raise UsageError(f"{source}: this is no table of text in UTF-8; those, {listed} can be read")
    content = source.read_bytes()
    try:
        text = content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("utf-16" if wide else "cp1252", "replace")
    return text.replace("\r\n", "\n").replace("\r", "\n").replace(MINUS, "-").split("\n")


def table_of_lines(
    source: Path, lines: Sequence[str], names: list[str], rules: ImportMap, separator: str | None = None
) -> tuple[polars.DataFrame, bool]:
    """Return lines as a table of texts, and whether its numbers have decimal commas."""
    import polars

    # a line of so few characters has no more cells
    check_width(source, max((most_cells(line) for line in lines if len(line) > MOST_COLUMNS), default=0))
    kept = table_of(lines, names, rules.comment)
    if rules.units_below:
        del kept[1:2]
    try:
        found = dialect_of(kept, rules.comment, rules.separator or separator, rules.header)
    except UsageError as fault:
        raise UsageError(f"{source}: {fault}") from None
    separator = found.separator
    if separator == BLANKS:
        kept, separator = ["\t".join(line.split()) for line in kept], "\t"
    if found.row_names:
        kept = [f"{separator}{kept[0]}", *kept[1:]]
    kept = with_whole_quotes(kept, separator)
    comma = rules.decimal_comma if rules.decimal_comma is not None else found.decimal_comma
    try:
        table = polars.read_csv(
            io.BytesIO("".join(f"{line}\n" for line in kept).encode()),
            has_header=found.header,
            separator=separator,
            comment_prefix=found.comment,
            encoding="utf8-lossy",
            infer_schema=False,
        )
    except polars.exceptions.PolarsError as error:
        raise UsageError(
            f"{source}: cannot be read as a table with {separator!r} between its columns: {first_line(error)}; the map may say "
            "separator, decimal_comma, header, skip_lines (before the header) and comment"
        ) from error
    table.columns = [name.replace('""', '"') if found.header else str(place + 1) for place, name in enumerate(table.columns)]
    return table, comma
