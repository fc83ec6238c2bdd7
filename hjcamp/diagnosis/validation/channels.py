"""The channels by which a model is judged: each sensor's predictions and each balance, with what no model can explain of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.repeatability import Repeatability

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Channels:
    """The columns of features (windows, d) that belong to each channel, its name, and its repeatability (channels,).

    Sensors come first, by the fields of their records; then balances, by the states that they are of.
    """

    names: tuple[str, ...]
    columns: tuple[slice, ...]
    repeatability: Repeatability

    def of(self, squares: Array) -> Array:
        """Return the means (..., channels) of numbers (..., d) over the features of each channel."""
        return np.stack([squares[..., one].mean(axis=-1) for one in self.columns], axis=-1)

    def above(self, features: Array) -> Array:
        """Return the mean square of features (windows, d) above repeatability, by more than that is unsure (channels,)."""
        known = self.repeatability
        return np.asarray(np.maximum(self.of(np.mean(features**2, axis=0)) - known.squares - known.unsure, 0.0))

    def excess(self, base: Array) -> Array:
        """Return what a base leaves above repeatability (channels,), and as much as that is unsure: below it a share means little."""
        return self.above(base) + self.repeatability.unsure

    def share(self, features: Array, before: Array, base: Array) -> float:
        """Return which share of a base's excess features (windows, d) explain beyond others, in the channel where it is largest."""
        return float(np.max((self.above(before) - self.above(features)) / self.excess(base)))

    def left(self, models: Sequence[Array], base: Array) -> list[Array]:
        """Return which share of a base's excess each of several features leaves (channels,)."""
        excess = self.excess(base)
        return [np.asarray(self.above(one) / excess) for one in models]
