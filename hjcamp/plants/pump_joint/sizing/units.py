"""Units in names: ``bore_mm: 10`` is the argument ``bore`` of 0.01 m."""

from __future__ import annotations

import math
from collections.abc import Mapping

DEG = math.pi / 180.0
#: Suffix of a name: its factor to SI. Longer suffixes come first, so that _mm_per_s is not _s.
SUFFIXES = {
    "_mm_per_s2": 1e-3, "_mm_per_s": 1e-3, "_mnm": 1e-3, "_mpa": 1e6, "_mm2": 1e-6, "_mm": 1e-3, "_deg": DEG,
}  # fmt: skip
#: Unit that is shown: its size in SI.
SHOWN = {
    "": 1.0, "rad": 1.0, "N": 1.0, "mm": 1e-3, "mm2": 1e-6, "mm/s": 1e-3, "mNm": 1e-3, "MPa": 1e6, "mNm/MPa": 1e-9, "deg": DEG,
    "deg/mm": DEG / 1e-3, "mm3/deg": 1e-9 / DEG, "ms": 1e-3,
}  # fmt: skip


def in_si(inputs: Mapping[str, float]) -> dict[str, float]:
    """Return inputs with their unit in the name as arguments in SI."""
    found = {}
    for name, value in inputs.items():
        suffix = next((one for one in SUFFIXES if name.endswith(one)), "")
        found[name.removesuffix(suffix)] = float(value) * SUFFIXES.get(suffix, 1.0)
    return found
