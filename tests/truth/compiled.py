"""Numba's cache watches one file only: a fingerprint of all sources keeps compiled machines from going stale."""

import zlib
from pathlib import Path

from numba import njit

# For what only compiled code calls: without wrappers that would take a rig of seventy numbers apart for Python and for C.
within = njit(no_cpython_wrapper=True, no_cfunc_wrapper=True)


def fingerprint_of(*modules: str) -> int:
    """Return a number that changes with the text of any of these modules; close a cached function over it."""
    folder = Path(__file__).parent
    return zlib.crc32(b"".join((folder / f"{name}.py").read_bytes() for name in modules))
