"""Put a report's files in place: whole or not at all."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import polars as pl

from hjcamp.report.tables.formats import escape_csv
from hjcamp.storage import whole_file


def replace_file(path: Path, content: bytes | str | Iterator[str]) -> None:
    """Write ``content``, or its pieces, to ``path``, whose name never holds a part of it; `HjcampError` where that fails."""
    with whole_file(path) as stream:
        for piece in (content,) if isinstance(content, bytes | str) else content:
            stream.write(piece.encode("utf-8") if isinstance(piece, str) else piece)


def write_frame(folder: Path, name: str, frame: pl.DataFrame) -> None:
    """Write ``name``.csv and ``name``.parquet into ``folder``."""
    texts = pl.col(pl.String)
    escaped = frame.with_columns(texts.map_elements(escape_csv, return_dtype=pl.String)).rename(escape_csv)
    replace_file(folder / f"{name}.csv", escaped.write_csv())
    buffer = io.BytesIO()
    frame.write_parquet(buffer)
    replace_file(folder / f"{name}.parquet", buffer.getvalue())
