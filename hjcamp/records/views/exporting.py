"""Write logs as tables that other programs read: Parquet, CSV, MATLAB, NumPy; fields, units and metadata go with them."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable, Sequence
from os.path import commonpath
from pathlib import Path
from typing import IO

import numpy as np

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.records.log import TestLog
from hjcamp.storage import check_place, whole_file

# MATLAB's longest name.
LONGEST_MAT = 63


def units_of_log(log: TestLog) -> dict[str, str]:
    """Return the unit of each field of a log, as it is written in it."""
    table = log.table
    return {name: table.field(name).unit if name in table.names else unit_of_field(name, "").shown for name in log.columns}


def _parquet(log: TestLog, stream: IO[bytes]) -> None:
    import polars

    about = {"units": json.dumps(units_of_log(log)), "hjcamp.test": json.dumps(log.metadata, sort_keys=True)}
    polars.DataFrame(log.columns).write_parquet(stream, metadata=about)


def _csv(log: TestLog, stream: IO[bytes]) -> None:
    import polars

    polars.DataFrame(log.columns).write_csv(stream)


def _npz(log: TestLog, stream: IO[bytes]) -> None:
    about = {"units": json.dumps(units_of_log(log)), "metadata": json.dumps(log.metadata, sort_keys=True)}
    arrays = {**log.columns, **{name: np.array(text) for name, text in about.items()}}
    np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]


def _mat(log: TestLog, stream: IO[bytes]) -> None:
    from scipy.io import savemat

    def named(pairs: dict[str, str]) -> dict[str, str]:
        return {
            re.sub(r"\W", "_", f"x{name}" if not name[:1].isalpha() else name)[:LONGEST_MAT]: text
            for name, text in pairs.items()
        }

    # savemat looks at the name of what it writes to, and our stream has one that is not its own yet
    content = io.BytesIO()
    about = {"units": named(units_of_log(log)), "metadata": named(log.metadata)}
    savemat(content, {**log.columns, **about}, long_field_names=True, do_compression=True, oned_as="column")
    stream.write(content.getvalue())


FORMATS: dict[str, Callable[[TestLog, IO[bytes]], None]] = {"parquet": _parquet, "csv": _csv, "mat": _mat, "npz": _npz}


def export_logs(logs: Sequence[Path], read: Callable[[Path], TestLog], kind: str, folder: Path) -> list[Path]:
    """Write each log as ``folder``/NAME.``kind`` and return the paths; NAME keeps the folders by which the logs differ.

    A CSV file has the fields' names with their units as its head, and its metadata in NAME.json. Raises ``UsageError`` for an
    unknown kind and for a file that exists, before anything is written.
    """
    if kind not in FORMATS:
        raise unknown("kind of table", kind, FORMATS, "--as")
    check_place(folder, "--into", folder=True)
    targets = [folder / f"{name}.{kind}" for name in _names(logs)]
    for target in targets:
        if target.exists():
            raise UsageError(f"{target} exists; it is left as it is. Give another folder (--into)")
    for done, (path, target) in enumerate(zip(logs, targets, strict=True)):
        try:
            log = read(path)
        except UsageError as fault:
            whole = (
                f"; {counted(done, 'table')} of {len(logs)} logs before it, in {folder}, {'is' if done == 1 else 'are'} whole"
            )
            raise UsageError(f"{fault}{whole if done else ''}") from fault
        with whole_file(target) as stream:
            FORMATS[kind](log, stream)
        if kind == "csv":
            about = {"units": units_of_log(log), "metadata": log.metadata}
            with whole_file(target.with_suffix(".json")) as stream:
                stream.write((json.dumps(about, indent=2, sort_keys=True) + "\n").encode())
    return targets


def _names(logs: Sequence[Path]) -> list[str]:
    """Return a name for each log: its path below what they share, folders joined by ``__``, without the suffix."""
    resolved = [path.resolve() for path in logs]
    shared = Path(commonpath([path.parent for path in resolved]))
    return ["__".join(path.relative_to(shared).with_suffix("").parts) for path in resolved]
