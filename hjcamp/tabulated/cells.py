"""A table of indicators as data: the mean of each cell, how far it is known, and the error of simulated means against it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.indicators import INDICATORS

Array = NDArray[np.float64]
#: Error that a model of the right form may have: this share of an indicator, and for a mean error this angle, deg. It is
#: what the constants of the reference are good for: rise time to 1 ms of 17, mass to a seventh, friction to a digit.
FORM_SHARE, FORM_ANGLE = 0.10, 0.10
#: From here on an error counts by its size, not by its square: some cells may be errors of print.
HUBER = 2.0
#: No indicator is compared below this, deg: a tenth of the encoder's count.
LEAST = 0.03


@dataclass(frozen=True)
class Cells:
    """Cells of one or more tables: ``rows`` are places in ``conditions``, ``columns`` places in `INDICATORS`.

    ``error_of_mean`` (deg) holds the scatter of the repetitions and the rounding. RMSE and largest error are compared as
    logarithms, the steady state error in degrees.
    """

    tables: tuple[str, ...]
    conditions: Sequence[Mapping[str, str]]
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    means: Array
    error_of_mean: Array
    step: float

    def __len__(self) -> int:
        return len(self.means)

    @property
    def logarithmic(self) -> NDArray[np.bool_]:
        """Which cells are compared as logarithms."""
        return np.asarray(self.columns != INDICATORS.index("sse_deg"))

    @property
    def sigma(self) -> Array:
        r"""Error of each cell on its scale: :math:`\sigma^2 = (s_m / m)^2 + 0.1^2`, for a mean error :math:`s_m^2 + (0.1°)^2`."""
        share = self.error_of_mean / np.maximum(np.abs(self.means), LEAST)
        return np.where(self.logarithmic, np.hypot(share, FORM_SHARE), np.hypot(self.error_of_mean, FORM_ANGLE))

    def of(self, indicators: Array) -> Array:
        """Return the simulated mean (cells,) of each cell from (conditions, repetitions, indicators)."""
        return np.asarray(indicators.mean(axis=1)[self.rows, self.columns])

    def errors(self, simulated: Array) -> Array:
        """Return (simulated - measured) / sigma of each cell."""
        return (self._scaled(simulated) - self._scaled(self.means)) / self.sigma

    def log_ratio(self, simulated: Array) -> float:
        """Return the mean of abs(log(simulated / measured)) over RMSE1, RMSE2 and largest error; NaN without any."""
        known = self.logarithmic
        if not known.any():
            return float("nan")
        return float(np.mean(np.abs(self._scaled(simulated) - self._scaled(self.means))[known]))

    def with_means(self, means: Array) -> Cells:
        """Return the same cells, known as well on their scales, with other means: a twin."""
        share = np.maximum(np.abs(means), LEAST) / np.maximum(np.abs(self.means), LEAST)
        return replace(
            self, means=means, error_of_mean=np.where(self.logarithmic, self.error_of_mean * share, self.error_of_mean)
        )

    def drawn(self, simulated: Array, generator: np.random.Generator) -> Cells:
        """Return a twin: ``simulated`` means with an error of form of the stated size, rounded as the table is."""
        draws = generator.standard_normal(len(simulated))
        moved = np.where(self.logarithmic, simulated * np.exp(FORM_SHARE * draws), simulated + FORM_ANGLE * draws)
        rounded = np.round(moved / self.step) * self.step if self.step else moved
        return self.with_means(np.where(self.logarithmic, np.maximum(rounded, max(self.step, LEAST)), rounded))

    def label(self, cell: int) -> tuple[str, str, str]:
        """Return table, condition and indicator of a cell."""
        condition = " ".join(self.conditions[self.rows[cell]].values())
        return self.tables[cell], condition, INDICATORS[self.columns[cell]]

    def of_table(self, table: str) -> NDArray[np.bool_]:
        """Return which cells are of ``table``."""
        return np.array([one == table for one in self.tables])

    def _scaled(self, means: Array) -> Array:
        return np.where(self.logarithmic, np.log(np.maximum(np.abs(means), LEAST)), means)


def robust(errors: Array) -> Array:
    """Return the loss of each normalised error: its square up to 2, growing linearly beyond (Huber 1964)."""
    size = np.abs(errors)
    return np.where(size <= HUBER, size**2, 2 * HUBER * size - HUBER**2)


def weights(errors: Array) -> Array:
    """Return the weight of each squared error with which least squares minimises the robust loss."""
    return np.minimum(1.0, HUBER / np.maximum(np.abs(errors), 1e-9))
