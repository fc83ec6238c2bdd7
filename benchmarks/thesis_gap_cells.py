"""The printed cells, how far each is known, and the error of a simulated table against them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from thesis_gap_rig import KEYS

from hjcamp.report.indicators import INDICATORS
from hjcamp.report.published import published_cells

Array = NDArray[np.float64]
#: The thesis prints to 0.1 deg.
PRINTED_STEP = 0.1
#: Error that a model of the right form may have: this share of an indicator, and for a mean error this angle.
FORM_SHARE = 0.10
FORM_ANGLE = 0.10
#: From here on an error counts by its size, not by its square: some cells may be errors of print.
HUBER = 2.0


@dataclass(frozen=True)
class Cells:
    """Printed means (cells,), what each stands for, and its standard error on the scale on which it is compared.

    RMSE and largest error are compared as logarithms, the steady state error in degrees.
    """

    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    printed: Array
    sigma: Array
    conditions: Sequence[dict[str, str]]

    @property
    def logarithmic(self) -> NDArray[np.bool_]:
        """Which cells are compared as logarithms."""
        return np.asarray(self.columns != INDICATORS.index("sse_deg"))

    def label(self, cell: int) -> tuple[str, ...]:
        """Return trajectory, controller, payload, orientation and indicator of a cell."""
        condition = self.conditions[self.rows[cell]]
        return (*(condition[key] for key in KEYS), INDICATORS[self.columns[cell]])

    def of(self, indicators: Array) -> Array:
        """Return the simulated mean of each cell from (conditions, repetitions, 4)."""
        return np.asarray(indicators.mean(axis=1)[self.rows, self.columns])

    def errors(self, means: Array, against: Array | None = None) -> Array:
        """Return (simulated - printed) / sigma of each cell."""
        printed = self.printed if against is None else against
        known = self.logarithmic
        safe = np.where(known, np.maximum(np.abs(means), 1e-3), 1.0)
        target = np.where(known, np.maximum(np.abs(printed), 1e-3), 1.0)
        return np.where(known, np.log(safe / target), means - printed) / self.sigma


def cells_for(conditions: Sequence[dict[str, str]], tables: Sequence[str], form: float = 1.0) -> Cells:
    r"""Return the printed cells of ``tables`` for these conditions; ``form`` scales the error of model form.

    .. math:: \sigma^2 = \left(\frac{s^2}{n - 1} + \frac{0.1^2}{12}\right) / m^2 + \sigma_f^2

    with m and s the printed mean and deviation (which divides by n), sigma_f = 10 % or, for a mean error, 0.1 deg.
    """
    rows, columns, printed, sigma = [], [], [], []
    for row in published_cells().iter_rows(named=True):
        place = {key: row[key] for key in KEYS}
        if row["table"] not in tables or place not in list(conditions):
            continue
        rows.append(list(conditions).index(place))
        columns.append(INDICATORS.index(row["indicator"]))
        printed.append(row["mean"])
        measured = row["std"] ** 2 / 6 + PRINTED_STEP**2 / 12
        if row["indicator"] == "sse_deg":
            sigma.append(np.sqrt(measured + (form * FORM_ANGLE) ** 2))
        else:
            sigma.append(np.sqrt(measured / row["mean"] ** 2 + (form * FORM_SHARE) ** 2))
    return Cells(np.array(rows), np.array(columns), np.array(printed), np.array(sigma), list(conditions))


def robust(errors: Array) -> Array:
    """Return the loss of each normalised error: its square up to 2, growing linearly beyond (Huber)."""
    size = np.abs(errors)
    return np.where(size <= HUBER, size**2, 2 * HUBER * size - HUBER**2)


def weights(errors: Array) -> Array:
    """Return the weight of each squared error with which least squares minimises the robust loss."""
    return np.minimum(1.0, HUBER / np.maximum(np.abs(errors), 1e-9))
