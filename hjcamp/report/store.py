"""Put a report's files in place: whole or not at all."""

from __future__ import annotations

import io
import os
from pathlib import Path

import polars as pl

from hjcamp.errors import HjcampError


def replace_file(path: Path, content: bytes | str) -> None:
    """Write ``content`` to ``path`` so that the name never holds a part of it; `HjcampError` where that fails."""
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:
            file.write(content.encode("utf-8") if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise HjcampError(f"cannot write {path}: {error.strerror or error}") from error


def write_frame(folder: Path, name: str, frame: pl.DataFrame) -> None:
    """Write ``name``.csv and ``name``.parquet into ``folder``."""
    replace_file(folder / f"{name}.csv", frame.write_csv())
    buffer = io.BytesIO()
    frame.write_parquet(buffer)
    replace_file(folder / f"{name}.parquet", buffer.getvalue())
