"""What the tour brings along: sample logs of a rig in which something hides, and the sealed answer."""

from __future__ import annotations

import base64
import io
import json
import lzma
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log
from hjcamp.storage import whole_file

FOLDER = Path(__file__).parent
SAMPLES = FOLDER / "samples.npz.xz"
SEALED = FOLDER / "answer.sealed"
METADATA = "metadata"
MARK = "about.txt"
ABOUT = """\
Sample logs of `hjcamp tour`, 24 tests of a simulated bench: 8 conditions with 3 repetitions each.
The bench is not the model of hjcamp: another program with other equations, its own friction, stiffness, noise and
scatter. In it hides one physical effect that the published model does not have.
This folder may be deleted; `hjcamp tour` makes it again.
"""


def pack(logs: dict[str, TestLog], path: Path) -> None:
    """Write logs by name into one file: every column as it is, under ``TEST/FIELD``, compressed together."""
    arrays: dict[str, Any] = {}
    for name, log in logs.items():
        arrays |= {f"{name}/{field}": values for field, values in log.columns.items()}
        arrays[f"{name}/{METADATA}"] = np.array(json.dumps(log.metadata, sort_keys=True))
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    with whole_file(path) as stream:
        stream.write(lzma.compress(buffer.getvalue(), preset=9))


def sample_logs(path: Path = SAMPLES) -> dict[str, TestLog]:
    """Return the sample logs by name."""
    logs: dict[str, TestLog] = {}
    with np.load(io.BytesIO(lzma.decompress(path.read_bytes()))) as arrays:
        for key in arrays.files:
            name, _, field = key.partition("/")
            log = logs.setdefault(name, TestLog({}))
            if field == METADATA:
                log.metadata.update(json.loads(str(arrays[key])))
            else:
                log.columns[field] = arrays[key]
    return logs


def seal(answer: dict[str, Any], path: Path) -> None:
    """Write the answer so that nobody reads it by accident."""
    text = base64.encodebytes(zlib.compress(json.dumps(answer).encode(), 9)).decode()
    with whole_file(path) as stream:
        stream.write(f"The sealed answer of `hjcamp tour`; `hjcamp tour --open` opens it.\n{text}".encode())


def sealed_answer(path: Path = SEALED) -> dict[str, Any]:
    """Return what hides in the sample logs."""
    text = path.read_text(encoding="utf-8").partition("\n")[2]
    return dict(json.loads(zlib.decompress(base64.b64decode(text))))


def lay_out(folder: Path) -> int:
    """Write the sample logs that are not there yet into ``folder``/logs and return how many there are.

    Raises UsageError where ``folder`` holds other things than a tour.
    """
    check_ours(folder, ABOUT)
    try:
        logs = sample_logs()
    except OSError as error:
        raise HjcampError(f"{error.filename or folder}: cannot be read: {error.strerror or error}") from error
    for name, log in logs.items():
        path = folder / "logs" / f"{name}.mcap"
        if not path.exists():
            write_log(path, log)
    return len(logs)


def check_ours(folder: Path, about: str) -> None:
    """Refuse a folder that holds other things than this tour; mark a new one with what it is ``about``."""
    mark = folder / MARK
    try:
        if folder.exists() and not folder.is_dir():
            raise UsageError(f"{folder}: this is a file; choose another folder with --into")
        ours = mark.is_file() and mark.read_bytes().startswith(about.encode()[:30])
        if folder.is_dir() and any(folder.iterdir()) and not ours:
            raise UsageError(f"{folder}: holds other things than this tour; choose another folder with --into")
    except OSError as error:
        raise HjcampError(f"{error.filename or folder}: cannot be read: {error.strerror or error}") from error
    with whole_file(mark) as stream:
        stream.write(about.encode())
