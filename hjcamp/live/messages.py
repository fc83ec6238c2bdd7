"""What the run tells the page's process: a head in JSON and, for samples, their columns as one block of doubles."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

LENGTHS = struct.Struct(">II")
# Far more than a test has at once: what is longer is no message of ours.
MOST_BYTES = 1 << 28

Message = tuple[dict[str, Any], bytes]


def packed(head: dict[str, Any], block: bytes = b"") -> bytes:
    """Return a message as bytes."""
    text = json.dumps(head).encode()
    return LENGTHS.pack(len(text), len(block)) + text + block


def block_of(columns: dict[str, NDArray[np.float64]]) -> bytes:
    """Return columns (n,) as the bytes of an array (n, columns)."""
    return np.column_stack(list(columns.values())).astype("<f8").tobytes()


def columns_of(names: list[str], block: bytes) -> dict[str, NDArray[np.float64]]:
    """Return the columns of a block; raises ``ValueError`` where it does not hold whole rows."""
    table = np.frombuffer(block, "<f8").reshape(-1, len(names))
    return {name: np.array(table[:, place]) for place, name in enumerate(names)}


def received(stream: IO[bytes]) -> Iterator[Message]:
    """Yield messages until the stream ends, in the middle of one too: then its writer is gone."""
    while len(lengths := _whole(stream, LENGTHS.size)) == LENGTHS.size:
        text, block = LENGTHS.unpack(lengths)
        if text + block > MOST_BYTES:
            return
        content = _whole(stream, text + block)
        if len(content) < text + block:
            return
        yield json.loads(content[:text]), content[text:]


def _whole(stream: IO[bytes], size: int) -> bytes:
    found = b""
    while len(found) < size and (piece := stream.read(size - len(found))):
        found += piece
    return found
