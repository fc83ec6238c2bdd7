"""What a model is given besides its parameters: measured motion along which it is driven, or inputs under which it is free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Course:
    """Measured motion along which a model is driven: one or more tests one after the other, n samples ``period`` apart.

    ``restart`` (n): 2 where a test begins, 1 where the observed states are set again, else 0. ``driven`` (n, driven
    states) and ``observed`` (n, the observed states) in SI; ``velocity`` (n, contacts) of each contact, 0 where it rests;
    ``given`` (n, inputs) as `inputs_along` makes them, which hold from each sample to the next.
    """

    period: float
    restart: NDArray[np.int64]
    time: Array
    driven: Array
    observed: Array
    velocity: Array
    given: Array


@dataclass(frozen=True)
class Given:
    """What tests are given: n samples ``period`` apart, one test after the other.

    ``begins`` (n): 1 where a test begins, 2 where a window of it begins, in which effects keep their own states; ``time`` (n);
    ``inputs`` (n, inputs) in the plant's order, which hold from each sample to the next; ``starts`` (tests and windows, plant
    states).
    """

    period: float
    begins: NDArray[np.int64]
    time: Array
    inputs: Array
    starts: Array


@dataclass(frozen=True)
class Followed:
    """Readings (n, channels), the observed states (n, observed) that belong to them, the plant's force balance
    (n, signals), all SI, and the number of steps taken.
    """

    readings: Array
    ideal: Array
    forces: Array
    steps: float
