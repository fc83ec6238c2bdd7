"""Put a report's files in place: whole or not at all."""

from __future__ import annotations

import io
from pathlib import Path

import polars as pl

from hjcamp.storage import whole_file


def replace_file(path: Path, content: bytes | str) -> None:
    """Write ``content`` to ``path`` so that the name never holds a part of it; `HjcampError` where that fails."""
    with whole_file(path) as stream:
        stream.write(content.encode("utf-8") if isinstance(content, str) else content)


def write_frame(folder: Path, name: str, frame: pl.DataFrame) -> None:
    """Write ``name``.csv and ``name``.parquet into ``folder``."""
    replace_file(folder / f"{name}.csv", frame.write_csv())
    buffer = io.BytesIO()
    frame.write_parquet(buffer)
    replace_file(folder / f"{name}.parquet", buffer.getvalue())
