"""Numba's cache watches one file only: a fingerprint of all sources keeps compiled machines from going stale."""

import zlib
from pathlib import Path


def fingerprint_of(*modules: str) -> int:
    """Return a number that changes with the text of any of these modules; close a cached function over it."""
    folder = Path(__file__).parent
    return zlib.crc32(b"".join((folder / f"{name}.py").read_bytes() for name in modules))
