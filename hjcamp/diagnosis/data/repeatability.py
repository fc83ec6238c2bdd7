"""What no model can remove: the part of the residuals that repetitions do not share, or that near-replicates differ by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.levels import DELTA, LEVEL, MOST_OF_IT

Array = NDArray[np.float64]
# Moments this far apart are looked at twice, not one after the other.
NEIGHBOURS = 10
FEWEST_PAIRS = 300
# Windows of which neighbours are looked for, evenly spread over more, and at once: memory grows with the windows, not their square.
MOST_LOOKED_AT, AT_ONCE = 4000, 256
FEWEST_REPEATED = 20
MOTION_ORDERS = 3


@dataclass(frozen=True)
class NoiseFloor:
    """Second moments (d, d) of what cannot be explained, in units of the sensors' noise, and where they come from.

    ``moments`` have one unit of noise more than that, as the likelihood gives it to what a model leaves: sizes of both compare.
    ``source`` is "repetitions", "near_replicates", or "sensor" where neither is there: then it is a lower bound only.
    """

    source: str
    moments: Array

    def of_sensors(self, layout: Layout) -> Array:
        """Return its rms in each sensor's unit (sensors,), SI: the sensor's noise at least."""
        return in_units(np.maximum(np.diag(self.moments) - 1.0, 1.0), layout)


@dataclass(frozen=True)
class Repeatability:
    """Mean squares (sensors,) of what repetitions of a window differ by, in units of the noise, and how far they are unsure."""

    squares: Array
    unsure: Array


def repeatability_of(
    layout: Layout, features: Array, channels: Sequence[slice], together: Sequence[float] | None = None
) -> Repeatability:
    """Return that of each channel (columns of features (windows, d)) of a calibrated model, no less than the sensors' noise.

    It is unsure by its one-sided interval at the level of all claims, over windows, of which in each channel so many ``together`` are
    independent (one unless given), and by the share of it that matters. Without
    repetitions all of an error counts, and as much as a sensor's noise, and the share of it that matters, is unsure.
    """
    from scipy.special import stdtrit

    repeated = _of_repetitions(layout, features)
    if repeated is None:
        return Repeatability(np.zeros(len(channels)), np.full(len(channels), 1.0 + DELTA))
    each = np.stack([(repeated[:, one] ** 2).mean(axis=1) for one in channels], axis=1)
    squares = np.maximum(each.mean(axis=0), 1.0)
    half = stdtrit(len(each) - 1, 1.0 - LEVEL) * each.std(axis=0, ddof=1) / np.sqrt(len(each) / np.array(together or 1.0))
    return Repeatability(squares, np.maximum(half, DELTA * squares))


def not_above(noise_floor: NoiseFloor, features: Array) -> NoiseFloor:
    """Return the noise floor, or that of the sensors where a model leaves less (features (windows, d)) than near-replicates differ by.

    Then the moments were not similar enough to say anything.
    """
    if noise_floor.source != "near_replicates":
        return noise_floor
    features = features[:, : len(noise_floor.moments)]
    left = features.T @ features / len(features) + np.eye(features.shape[1])
    if np.linalg.slogdet(left)[1] >= np.linalg.slogdet(noise_floor.moments)[1]:
        return noise_floor
    return NoiseFloor("sensor", 2.0 * np.eye(features.shape[1]))


def in_units(squares: Array, layout: Layout) -> Array:
    """Return the rms (sensors,), SI, of mean squares of features (d,); of their predictions, where there are balances too."""
    each = layout.predictions(squares).reshape(len(layout.measured.sensors), -1).sum(axis=1)
    return np.asarray(layout.measured.noise * np.sqrt(each / layout.width))


def noise_floor_of(layout: Layout, features: Array) -> NoiseFloor:
    """Return the noise floor by features (windows, d) of a calibrated model."""
    d = features.shape[1]
    repeated = _of_repetitions(layout, features)
    if repeated is not None:
        moments = repeated.T @ repeated / len(repeated) + np.eye(d)
        return NoiseFloor("repetitions", moments)
    # what is simulated through depends on more of the past than a window shows: windows that are alike need not err alike
    near = None if layout.memory else _of_neighbours(layout, features)
    if near is not None and not _near_replicates_uninformative(near, features):
        return NoiseFloor("near_replicates", near + np.eye(d))
    return NoiseFloor("sensor", 2.0 * np.eye(d))


def _near_replicates_uninformative(near: Array, features: Array) -> bool:
    """Whether windows of like motion differ by most of what any windows do, far above the noise: that is scatter, or a structure finer
    than their likeness, and no one can tell.
    """
    whole = features.T @ features / len(features)
    if np.trace(whole) * (1.0 - MOST_OF_IT) ** 2 <= len(whole):
        return False
    return bool(np.trace(np.linalg.solve(whole + np.eye(len(whole)), near)) > MOST_OF_IT * len(whole))


def _of_repetitions(layout: Layout, features: Array) -> Array | None:
    r"""Return by what n repetitions of a window differ, :math:`\sqrt{n / (n - 1)} (f - \bar f)` (windows, d): the pure error."""
    found = []
    for tests in layout.measured.conditions.values():
        if len(tests) < 2:
            continue
        block = _side_by_side(layout, features, tests)
        apart = (block - block.mean(axis=0)) * math.sqrt(len(tests) / (len(tests) - 1))
        found.append(apart.reshape(-1, features.shape[1]))
    every = np.concatenate(found) if found else np.zeros((0, features.shape[1]))
    return every if len(every) >= FEWEST_REPEATED else None


def shared(layout: Layout, features: Array, tests: Sequence[int]) -> Array | None:
    r"""Return the rms (sensors,), SI, that the repetitions of a condition share; None for a single test.

    .. math:: s^2 = \max\Bigl(\frac{1}{R (R - 1)} \sum_{r \ne r'} \overline{f_r f_{r'}},\ 0\Bigr)

    for R repetitions of each window: what they differ by cancels.
    """
    if len(tests) < 2:
        return None
    block = _side_by_side(layout, features, tests)
    if not block.shape[1]:
        return None
    squares = (block.sum(axis=0) ** 2 - (block**2).sum(axis=0)).mean(axis=0) / (len(tests) * (len(tests) - 1))
    # sensors are summed before the root: single features may come out below zero
    summed = layout.predictions(squares).reshape(len(layout.measured.sensors), -1).sum(axis=1)
    return np.asarray(layout.measured.noise * np.sqrt(np.maximum(summed, 0.0) / layout.width))


def _side_by_side(layout: Layout, features: Array, tests: Sequence[int]) -> Array:
    """Return the features of the windows that all tests of a condition have (tests, windows, d)."""
    rows = [np.flatnonzero(layout.of_test == test) for test in tests]
    shortest = min(len(one) for one in rows)
    return np.stack([features[one[:shortest]] for one in rows])


def _of_neighbours(layout: Layout, features: Array) -> Array | None:
    r"""Return the second moments (d, d) at distance 0 of windows of like motion and inputs: the Gamma test.

    The intercept of half the mean squared difference over the mean squared distance of the p nearest neighbours, p = 1 .. 10
    (Evans & Jones 2002, doi:10.1098/rspa.2002.1010), for each pair of features; no more than at the nearest neighbour.
    """
    motion = motion_of(layout, layout.readings)
    count, d = len(motion), features.shape[1]
    if count < 4 * NEIGHBOURS or count * NEIGHBOURS < FEWEST_PAIRS:
        return None
    rows = np.unique(np.linspace(0, count - 1, min(count, MOST_LOOKED_AT)).round().astype(np.int64))
    parts = [_neighbours(motion, some) for some in np.array_split(rows, -(-len(rows) // AT_ONCE))]
    order, distance = np.concatenate([one for one, _ in parts]), np.concatenate([one for _, one in parts]).mean(axis=0)
    halves = []
    for p in range(NEIGHBOURS):
        difference = features[rows] - features[order[:, p]]
        halves.append((0.5 * difference.T @ difference / len(rows)).ravel())
    line = np.column_stack([np.ones(NEIGHBOURS), distance])
    intercept = np.linalg.lstsq(line, np.array(halves), rcond=None)[0][0].reshape(d, d)
    # within the nearest neighbours' own differences, in whose coordinates each part lies between 0 and 1
    root = np.linalg.cholesky(halves[0].reshape(d, d) + np.eye(d))
    inside = np.linalg.solve(root, np.linalg.solve(root, 0.5 * (intercept + intercept.T)).T)
    values, vectors = np.linalg.eigh(inside)
    part = root @ vectors
    return np.asarray((part * np.clip(values, 0.0, 1.0)) @ part.T)


def _neighbours(motion: Array, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array]:
    """Return the nearest neighbours of some rows of a motion (windows, m), the nearest first, and their squared distances (rows, p).

    A window next to it is none.
    """
    size = np.sum(motion**2, axis=1)
    squares = np.maximum(size[rows, None] + size[None, :] - 2.0 * motion[rows] @ motion.T, 0.0) / motion.shape[1]
    squares[np.abs(rows[:, None] - np.arange(len(motion))[None, :]) <= 1] = np.inf
    near = np.argpartition(squares, NEIGHBOURS, axis=1)[:, :NEIGHBOURS]
    own = np.take_along_axis(squares, near, axis=1)
    order = np.argsort(own, axis=1)
    return np.take_along_axis(near, order, axis=1), np.take_along_axis(own, order, axis=1)


def motion_of(layout: Layout, readings: Array) -> Array:
    """Return what describes each window (windows, m): the first coefficients of readings and inputs, each of unit spread.

    ``readings`` (n, sensors) are those that were measured or predicted.
    """
    found = _first_coefficients(layout, readings)
    return np.asarray((found - found.mean(axis=0)) / np.maximum(found.std(axis=0), 1e-300))


def moves(layout: Layout) -> NDArray[np.bool_]:
    """Return which of the numbers that describe windows (m,) differ by more than noise: what is mostly noise is no motion."""
    spread = _first_coefficients(layout, layout.readings).var(axis=0).reshape(-1, MOTION_ORDERS)
    sensors = len(layout.measured.sensors)
    least = np.concatenate([layout.measured.noise**2 / MOST_OF_IT, np.zeros(len(spread) - sensors)])
    return np.asarray(spread > least[:, None]).ravel()


def _first_coefficients(layout: Layout, readings: Array) -> Array:
    """Return the first coefficients (windows, m) of readings (n, sensors), and of inputs that change."""
    inputs = layout.inputs[:, np.std(layout.inputs, axis=0) > 0.0]
    columns = np.column_stack([readings, inputs])
    shaped = columns.reshape(-1, layout.width, columns.shape[1])
    return np.asarray(np.einsum("wtc,to->wco", shaped, layout.basis[:, :MOTION_ORDERS]).reshape(len(shaped), -1))
