"""Where a calibrated model fails: which channel, condition, and range of what was measured holds its error above repeatability."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.errors import plain

Array = NDArray[np.float64]
PARTS, MOST = 4, 8
# Standard deviations by which the error in a range is larger than elsewhere.
STANDS_OUT = 3.0


@dataclass(frozen=True)
class _Split:
    """A way to split windows (windows,): the part that each belongs to, and what each part is called."""

    of_window: NDArray[np.int64]
    names: tuple[str, ...]


def where_rows(analysis: Analysis) -> list[dict[str, Any]]:
    """Return the ranges in which the calibrated base errs most above repeatability, the largest share of all excess first.

    ``share`` is the part of a channel's excess (mean square above repeatability, blocks left out) in a range, weighed by what the
    channel has of all excess; ``z`` by how many standard deviations the range errs more than all windows. A channel is split by what
    explains most of where it errs.
    """
    channels, base = analysis.channels, analysis.base.features
    above, rows = channels.above(base), []
    if not above.any():
        return []
    squares = channels.of(base**2) - channels.repeatability.squares
    splits = list(_splits(analysis))
    for k in np.flatnonzero(above > 0.0):
        best = max(splits, key=lambda one: _explained(squares[:, k], one.of_window), default=None)
        found = _rows(squares[:, k], best) if best else []
        weight = float(above[k] / above.sum())
        sensors = analysis.measured.sensors
        balance = k >= len(sensors)
        quantity = channels.names[k] if balance else sensors[k].quantity
        rows += [
            {"subsystem": quantity, "variable": "balance" if balance else "prediction", **row, "share": weight * row["share"]}
            for row in found
        ]
    return sorted(rows, key=lambda row: -row["share"])[:MOST]


def _rows(excess: Array, split: _Split) -> Iterator[dict[str, Any]]:
    """Yield the parts of a split in which an excess (windows,) stands out, with the share that they hold of it."""
    whole, spread, count = float(excess.sum()), float(excess.std()), len(excess)
    for part, name in enumerate(split.names):
        own = excess[split.of_window == part]
        if not 0 < len(own) < count or spread == 0.0:
            continue
        z = float((own.mean() - excess.mean()) / (spread * math.sqrt(1.0 / len(own) - 1.0 / count)))
        if z > STANDS_OUT:
            yield {"bin": name, "share": min(float(own.sum()) / whole, 1.0), "z": z}


def _explained(excess: Array, of_window: NDArray[np.int64]) -> float:
    """Return by how much the means of parts differ: their sum of squares over what is expected of as many parts by chance."""
    parts = [excess[of_window == one] for one in np.unique(of_window)]
    if len(parts) < 2:
        return 0.0
    between = sum(len(one) * (one.mean() - excess.mean()) ** 2 for one in parts) / (len(parts) - 1)
    return float(between / max(float(excess.var()), 1e-300))


def _splits(analysis: Analysis) -> Iterator[_Split]:
    """Yield the ways to split the windows: by condition, by each reading and each input that changes, by the way of each reading."""
    layout = analysis.windows.layout
    measured = layout.measured
    of_test = {test: number for number, tests in enumerate(measured.conditions.values()) for test in tests}
    if len(measured.conditions) > 1:
        yield _Split(np.array([of_test[int(one)] for one in layout.of_test]), tuple(measured.conditions))
    shaped = layout.readings.reshape(-1, layout.width, layout.readings.shape[1])
    for k, sensor in enumerate(measured.sensors):
        name, values = sensor.quantity.replace("_", " "), shaped[:, :, k] * sensor.scale
        yield from _ranges(name, values.mean(axis=1), sensor.unit)
        moved = values[:, -1] - values[:, 0]
        if np.ptp(np.sign(moved)) > 1.0:
            yield _Split((moved < 0.0).astype(np.int64), (f"{name} rises", f"{name} falls"))
    given = layout.inputs.reshape(len(layout.of_test), -1, layout.inputs.shape[1]).mean(axis=1)
    known = [(name, item) for name, item in measured.plant.inputs.items() if name not in ("time", "direction")]
    for k, (name, item) in enumerate(known):
        yield from _ranges(name.replace("_", " "), given[:, k], item.unit)


def _ranges(name: str, values: Array, unit: str) -> Iterator[_Split]:
    """Yield the split of windows by ranges of what they have on average (windows,), as many windows in each; none of a constant."""
    ends = np.unique(np.quantile(values, np.linspace(0.0, 1.0, PARTS + 1)))
    if len(ends) < 3:
        return
    names = tuple(f"{name} {plain(low, 3)} to {plain(high, 3)} {unit}".rstrip() for low, high in itertools.pairwise(ends))
    yield _Split(np.clip(np.searchsorted(ends, values, side="right") - 1, 0, len(names) - 1).astype(np.int64), names)
