"""Fitted models with what they leave of blocks left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.estimation.gauss_newton import Fitted
from hjcamp.diagnosis.residuals.windows import Place

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scored:
    """A fitted model with what it was made of, and its features (windows, d) on held-out blocks, with their size.

    ``place`` is where the windows begin for it. Two are equal where they are one.
    """

    names: tuple[str, ...]
    fitted: Fitted
    features: Array
    left_out: float
    place: Place

    def beyond(self, other: Scored) -> tuple[str, ...]:
        """Return the names of effects that another model lacks."""
        return tuple(name for name in self.names if name not in other.names)
