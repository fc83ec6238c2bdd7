"""How punctual the loop is: what keeps others out of its way, and the time from sample to sample."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise

import numpy as np

BIN_MS = (0.0, 0.9, 1.1, 1.5, 2.0, 3.0, 5.0, 10.0)
# The thread that writes the log gives way to the loop within it; Python's own is 5 ms. Measured: 0.1 ms is a little
# worse, and so is 0.005 ms, where the two spend their time on changing places.
SWITCH_INTERVAL_S = 2e-5


@contextmanager
def undisturbed() -> Iterator[None]:
    """While open, no garbage is collected (0.5 ms, a whole collection 100 ms) and the loop is served before others."""
    interval, collecting = sys.getswitchinterval(), gc.isenabled()
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    gc.disable()
    try:
        yield
    finally:
        sys.setswitchinterval(interval)
        if collecting:
            gc.enable()


class LoopTiming:
    """Counts cycles by their length. A virtual rig has no wall clock: there a cycle is 1 ms and what was missed."""

    def __init__(self, longest: int, virtual: bool) -> None:
        self._lengths = np.zeros(longest)
        self._cycles = 0
        self._last: int | None = None
        self._virtual = virtual

    def cycle(self, now_ns: int, missed: int) -> None:
        """Note one sample, read at ``now_ns``."""
        if self._last is not None and self._cycles < len(self._lengths):
            self._lengths[self._cycles] = 1.0 + missed if self._virtual else (now_ns - self._last) * 1e-6
            self._cycles += 1
        self._last = now_ns

    def histogram(self) -> str:
        """Return the number of cycles by length, such as ``0.9-1.1ms:2993 1.1-1.5ms:7``."""
        lengths = self._lengths[: self._cycles]
        counts = np.histogram(lengths, bins=[*BIN_MS, np.inf])[0]
        names = [f"{low:g}-{high:g}ms" for low, high in pairwise(BIN_MS)] + [f"{BIN_MS[-1]:g}ms-"]
        return " ".join(f"{name}:{count}" for name, count in zip(names, counts, strict=True) if count)
