"""A test of any plant that could be made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Wanted:
    """A test that could be made: ``inputs`` (n, inputs) are given, or ``readings`` (n, sensors) are how it is to move, SI.

    ``of`` is the measured test whose start, or whose inputs, it takes; ``given`` are parameters of this test, ``changes`` says in
    numbers what is other than in the logs. ``pieces`` are (value, seconds) of one input, for a campaign. It begins ``begun`` times as
    far as the measured test from where that ends.
    """

    name: str
    text: str
    of: int
    inputs: Array
    readings: Array
    given: tuple[tuple[str, float], ...] = ()
    changes: Mapping[str, float] = field(default_factory=dict)
    cost: float = 1.0
    start_at: int = 0
    pieces: tuple[tuple[float, float], ...] = ()
    driven: str = ""
    begun: float = 1.0

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.inputs)
