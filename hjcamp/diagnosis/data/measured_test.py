"""One measured test as arrays in SI units."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hjcamp.records.log import TestLog

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MeasuredTest:
    """One test, SI: ``time`` (n,), ``inputs`` (n, inputs of the plant), ``readings`` (n, sensors).

    ``given`` are plant parameters that its metadata give (a mass, a supply). ``earlier`` are inputs (samples, inputs) that were logged
    before the test begins; what was given before them is not known, and taken to be the first of them.
    """

    name: str
    condition: str
    time: Array
    inputs: Array
    readings: Array
    given: tuple[tuple[str, float], ...]
    log: TestLog
    earlier: Array = field(default_factory=lambda: np.empty((0, 0)))

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.time)
