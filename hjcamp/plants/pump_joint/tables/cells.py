"""A table of indicators as data: the mean of each cell, how far it is known, and the error of simulated means against it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from hjcamp.report.runs.indicators import INDICATORS

Array = NDArray[np.float64]
#: Error that a model of the right form may have: this share of an indicator, and for a mean error this angle, deg. It is
#: what the constants of the reference are good for: rise time to 1 ms of 17, mass to a seventh, friction to a digit.
FORM_SHARE, FORM_ANGLE = 0.10, 0.10
#: From here on an error counts by its size, not by its square: some cells may be errors of print.
HUBER = 2.0
#: Least share of that error that is left where a model meets every cell.
LEAST_FORM = 0.01
#: Tests that are simulated for each condition, to fit and to judge.
SIMULATED = 5
#: No indicator is compared below this, deg: a tenth of the encoder's count.
LEAST = 0.03


@dataclass(frozen=True)
class Cells:
    """Cells of one or more tables: ``rows`` are places in ``conditions``, ``columns`` places in `INDICATORS`.

    ``error_of_mean`` (deg) holds the scatter of the measured tests and the rounding, ``error_of_simulated`` (deg) that of
    the `SIMULATED` tests, which scatter as the measured ones do. RMSE and largest error are compared as logarithms, the
    steady state error in degrees. ``form`` is the share of the allowed error of form that these cells are judged by.
    """

    tables: tuple[str, ...]
    conditions: Sequence[Mapping[str, str]]
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    means: Array
    error_of_mean: Array
    step: float
    error_of_simulated: Array | float = 0.0
    form: float = 1.0

    def __len__(self) -> int:
        return len(self.means)

    @property
    def logarithmic(self) -> NDArray[np.bool_]:
        """Which cells are compared as logarithms."""
        return np.asarray(self.columns != INDICATORS.index("sse_deg"))

    @property
    def sigma(self) -> Array:
        r"""Error of each cell on its scale, with the form's share of 0.1, or 0.1 deg of a mean error.

        .. math:: \sigma^2 = (s_m^2 + s_s^2) / m^2 + 0.1^2, \quad \sigma_{sse}^2 = s_m^2 + s_s^2 + (0.1°)^2
        """
        known = np.hypot(self.error_of_mean, self.error_of_simulated)
        share = known / np.maximum(np.abs(self.means), LEAST)
        return np.where(self.logarithmic, np.hypot(share, self.form * FORM_SHARE), np.hypot(known, self.form * FORM_ANGLE))

    def of(self, indicators: Array) -> Array:
        """Return the simulated mean (cells,) of each cell from (conditions, repetitions, indicators)."""
        return np.asarray(indicators.mean(axis=1)[self.rows, self.columns])

    def errors(self, simulated: Array) -> Array:
        """Return (simulated - measured) / sigma of each cell."""
        return (self._scaled(simulated) - self._scaled(self.means)) / self.sigma

    def known_by(self, simulated: Array, fitted: int) -> Cells:
        """Return the same cells with the error of form that a model of ``fitted`` quantities leaves, where that is less.

        As in a least-squares fit whose scatter is not known before: the loss is then that of as many cells as are free.
        """
        free = max(len(self) - fitted, 1)

        def left(form: float) -> float:
            return float(robust(replace(self, form=form).errors(simulated)).sum()) - free

        if left(1.0) >= 0.0:
            return self
        return replace(self, form=float(brentq(left, LEAST_FORM, 1.0, xtol=1e-4)) if left(LEAST_FORM) > 0.0 else LEAST_FORM)

    def with_means(self, means: Array) -> Cells:
        """Return the same cells, known as well on their scales, with other means: a null replicate."""
        share = np.maximum(np.abs(means), LEAST) / np.maximum(np.abs(self.means), LEAST)
        scale = np.where(self.logarithmic, share, 1.0)
        return replace(
            self,
            means=means,
            error_of_mean=self.error_of_mean * scale,
            error_of_simulated=self.error_of_simulated * scale,
        )

    def drawn(self, simulated: Array, generator: np.random.Generator) -> Cells:
        """Return a null replicate: ``simulated`` means moved by errors of the size that each cell may have, rounded as the table is."""
        draws = self.sigma * generator.standard_normal(len(simulated))
        moved = np.where(self.logarithmic, simulated * np.exp(draws), simulated + draws)
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
