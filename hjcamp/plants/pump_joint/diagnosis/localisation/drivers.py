"""What the unexplained part depends on: regression of the residual force and flow on what could drive them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features

Array = NDArray[np.float64]
DRIVERS = (
    "arm_angle",
    "arm_velocity",
    "direction",
    "pressure_sum",
    "pressure_difference",
    "pump_position",
    "pump_velocity",
    "time",
    "time_at_rest",
    "repetition",
)
# Wide for a slope, narrow for a spot.
KNOTS = (5, 9, 21)
# A force is a pressure difference and a line error is one too: those pairs would explain themselves. What pushes the
# arm cannot know of the pump, whose motion is so like the arm's that it would take the arm's place by chance.
TAUTOLOGIES = {
    "sliding": ("pressure_difference", "pump_position", "pump_velocity"),
    "line_difference": ("pressure_difference",),
    "line_sum": ("pressure_sum",),
}
# Below 4 Hz a swing cannot be told from the motion's own harmonics; in steps that a test of ten seconds hardly resolves.
FREQUENCIES = np.arange(4.0, 24.0, 0.05)
FEWEST_BLOCKS = 15
# A test moves at a frequency itself where so much of its speed or direction swings with it, beyond what chance makes.
MOVES = 0.05
BENDS = np.linspace(0.125, 0.875, 11)
EXPLAINED = {"sliding": 4, "line_sum": 2, "line_difference": 3}


def driver_values(features: Features) -> dict[str, Array]:
    """Return every driver (blocks,), block by block."""
    evidence = features.evidence
    starts = features._starts
    at = starts + 2
    velocity = evidence.joined("velocity")
    pump = evidence.joined("pump")
    rest = np.zeros(len(velocity))
    for k in range(1, len(rest)):
        rest[k] = rest[k - 1] + 0.004 if velocity[k] == 0.0 else 0.0
    repetition = np.zeros(len(evidence.tests))
    for tests in evidence.conditions.values():
        repetition[tests] = np.arange(len(tests))
    sums = evidence.joined("pressure1") + evidence.joined("pressure2")
    return {
        "arm_angle": evidence.joined("arm")[at],
        "arm_velocity": np.abs(velocity)[at],
        "direction": np.sign(velocity)[at],
        "pressure_sum": sums[at],
        "pressure_difference": (evidence.joined("pressure1") - evidence.joined("pressure2"))[at],
        "pump_position": pump[at],
        "pump_velocity": np.gradient(pump, 0.004)[at],
        "time": evidence.joined("time")[at],
        "time_at_rest": rest[at],
        "repetition": repetition[features.of_test],
    }


def _basis(values: Array, sign: Array | None, count: int = KNOTS[0]) -> Array:
    """Return piecewise linear functions of the values (blocks, ``count``), times the direction for an odd part."""
    low, high = np.quantile(values, [0.02, 0.98])
    if high <= low:
        return np.zeros((len(values), 0))
    distinct = np.unique(np.round(values, 12))
    if len(distinct) <= 3:
        columns = [(values == value).astype(float) for value in distinct[1:]]
    else:
        knots = np.linspace(low, high, count)
        width = knots[1] - knots[0]
        columns = [np.clip(1 - np.abs(np.clip(values, low, high) - knot) / width, 0, 1) for knot in knots]
    basis = np.column_stack(columns)
    return basis if sign is None else basis * sign[:, None]


def _gain(features: Features, residual: Array, valid: NDArray[np.bool_], basis: Array) -> float:
    """Return the share of the squared residual that the basis predicts in conditions left out of the regression."""
    if basis.shape[1] == 0 or valid.sum() < 50:
        return 0.0
    conditions = list(features.evidence.conditions.values())
    before, after = 0.0, 0.0
    for tests in conditions:
        out = np.isin(features.of_test, tests) & valid
        inside = valid & ~np.isin(features.of_test, tests)
        if out.sum() < 5 or inside.sum() < 3 * basis.shape[1]:
            continue
        a = basis[inside]
        ridge = (1e-3 * np.trace(a.T @ a) / a.shape[1] + 1e-12) * np.eye(a.shape[1])
        weights = np.linalg.solve(a.T @ a + ridge, a.T @ residual[inside])
        before += float((residual[out] ** 2).sum())
        after += float(((residual[out] - basis[out] @ weights) ** 2).sum())
    return 1.0 - after / before if before > 0 else 0.0


@dataclass(frozen=True)
class Swing:
    """Of one test the blocks that say anything, cosine and sine (frequencies, n, 2) there, and which frequencies count."""

    inside: NDArray[np.bool_]
    basis: Array
    counts: NDArray[np.bool_]


def _swings(features: Features, valid: NDArray[np.bool_], values: dict[str, Array]) -> dict[int, Swing]:
    """Return what may swing in the tests that say enough.

    A frequency at which a test moves itself does not count there: what friction leaves swings with the harmonics of the motion.
    """
    time, speed = values["time"], np.abs(values["arm_velocity"])
    motion = [values["arm_velocity"], speed, values["pump_velocity"], values["direction"]]
    found: dict[int, Swing] = {}
    for test in range(len(features.counts)):
        inside = valid & (features.of_test == test)
        number = int(inside.sum())
        if number < FEWEST_BLOCKS:
            continue
        angle = 2 * np.pi * FREQUENCIES[:, None] * time[inside][None]
        basis = np.stack([np.cos(angle), np.sin(angle)], axis=2)
        basis -= basis.mean(axis=1, keepdims=True)
        moves = np.zeros(len(FREQUENCIES), dtype=bool)
        for column in motion:
            own = column[inside] - column[inside].mean()
            moves |= _swing(basis, own) > (MOVES + 6.0 / number) * float(own @ own)
        # what a test of that length cannot tell from one of these
        near = np.abs(FREQUENCIES[:, None] - FREQUENCIES[moves]) < 1.0 / np.ptp(time[inside])
        found[test] = Swing(inside, basis, ~near.any(axis=1))
    return found


def _rhythm(features: Features, residual: Array, swings: dict[int, Swing]) -> float:
    """Return the share of the squared residual that swings with one frequency, found in the other conditions each time.

    The median of the conditions. Phase and size are free in each test, since nothing says that a test begins in step
    with what shakes it; what two free numbers explain of noise is taken off.
    """
    tests = list(range(len(features.counts)))
    whole, swing = np.zeros(len(tests)), np.zeros((len(tests), len(FREQUENCIES)))
    for test, one in swings.items():
        seen = residual[one.inside] - residual[one.inside].mean()
        whole[test] = float(seen @ seen)
        swing[test] = np.where(one.counts, _swing(one.basis, seen) - 2.0 / len(seen) * whole[test], 0.0)
    shares = []
    for out in features.evidence.conditions.values():
        others = [test for test in tests if test not in out]
        if others and whole[out].sum() > 0:
            place = int(np.argmax(swing[others].sum(axis=0)))
            shares.append(float(swing[out][:, place].sum() / whole[out].sum()))
    return float(np.median(shares)) if shares else 0.0


def _swing(basis: Array, seen: Array) -> Array:
    """Return the sum of squares (frequencies,) of ``seen`` (n,) that each pair of columns (frequencies, n, 2) explains."""
    cross = np.tensordot(basis, seen, axes=(1, 0))
    square = np.matmul(basis.transpose(0, 2, 1), basis) + 1e-6 * len(seen) * np.eye(2)
    return np.asarray(np.einsum("fk,fk->f", cross, np.linalg.solve(square, cross[:, :, None])[:, :, 0]))


def rank_drivers(
    features: Features, fit: Fit, noise_floor: Array, barred: Mapping[str, Sequence[str]] = TAUTOLOGIES
) -> list[tuple[str, str, float]]:
    """Return (driver, channel, share explained on conditions left out), largest first, of the channel most off its floor.

    Slopes and spots are looked for alike, with few knots and with many. A force that is even in direction is looked for as
    it is, friction as its product with the direction; a force in time may also swing with one frequency. ``barred`` are
    drivers that are not looked at in a channel.
    """
    values = driver_values(features)
    sign = values["direction"]
    found = []
    for channel, index in EXPLAINED.items():
        valid = features.valid[:, index]
        residual = fit.features[:, index]
        power = float((residual[valid] ** 2).sum()) / max(noise_floor[index] ** 2 * valid.sum(), 1e-30)
        excess = max(1.0 - 1.0 / max(power, 1e-9), 0.0) * min(power, 25.0)
        for driver, column in values.items():
            if driver in barred.get(channel, ()):
                continue
            best = max(_gain(features, residual, valid, _basis(column, None, count)) for count in KNOTS)
            if channel == "sliding":
                odd = max(_gain(features, residual, valid, _basis(column, sign, count)) for count in KNOTS)
                best = max(best, 0.98 * odd)
            if driver == "time" and channel == "sliding":
                best = max(best, 0.8 * _rhythm(features, residual, _swings(features, valid, values)))
            found.append((driver, channel, best * max(excess, 0.05)))
    return sorted(found, key=lambda row: -row[2])


def share_left(features: Features, fit: Fit, driver: str) -> float:
    """Return the share of the unexplained sliding force that depends on a driver alike in both directions.

    Measured on conditions left out of the regression; 0 and less where it depends on it no more.
    """
    index = EXPLAINED["sliding"]
    basis = _basis(driver_values(features)[driver], None)
    return _gain(features, fit.features[:, index], features.valid[:, index], basis)


def foreign_shares(features: Features, residuals: Sequence[Array]) -> list[dict[str, float]]:
    """Return for each residual, by driver, the share of the sliding force that depends on what no base parameter knows of.

    ``residuals`` are features (blocks, channels). The arm's angle, with and without the direction, and one frequency in time.
    """
    index = EXPLAINED["sliding"]
    valid, values = features.valid[:, index], driver_values(features)
    bases = [_basis(values["arm_angle"], sign, count) for sign in (None, values["direction"]) for count in KNOTS]
    # friction that is off everywhere is no friction at an angle
    level = np.column_stack([np.ones(len(valid)), values["direction"]])
    found, swings = [], _swings(features, valid, values)
    for one in residuals:
        left = one[:, index] - level @ np.linalg.lstsq(level[valid], one[valid, index], rcond=None)[0]
        angle = max(_gain(features, left, valid, basis) for basis in bases)
        found.append({"arm_angle": angle, "time": _rhythm(features, left, swings)})
    return found


def bends(driver: Array, valid: NDArray[np.bool_]) -> list[Array]:
    """Return forces (blocks,) that set in at one place of the driver and grow from there, upwards or downwards."""
    places = np.quantile(driver[valid], BENDS)
    return [np.maximum(side * (driver - place), 0.0) for side in (1.0, -1.0) for place in places]


def outdone(
    features: Features, force: Array, law: Array, shapes: Sequence[Array], sign: Array, valid: NDArray[np.bool_]
) -> float:
    r"""Return by how many standard errors the best of some shapes fits a force better than a law does.

    .. math:: z = \frac{\sum_t d_t}{s_d \sqrt{T}}, \quad d_t = \log \overline{e^2_{law}} - \log \overline{e^2_{shape}}

    over T tests, each predicted from the other conditions, where the shape is chosen, too. ``force`` (blocks,) is what the
    law is to explain, ``law`` what it says, ``sign`` the direction; law and shapes may be off by a factor and by a constant in
    each direction. Where a law is nearly the shape itself, z is near 0.
    """
    columns = [np.column_stack([np.ones(len(force)), sign, column]) for column in (law, *shapes)]
    ahead = []
    for tests in features.evidence.conditions.values():
        others = valid & ~np.isin(features.of_test, tests)
        if others.sum() < FEWEST_BLOCKS:
            continue
        weights = [np.linalg.lstsq(basis[others], force[others], rcond=None)[0] for basis in columns]
        errors = [(force - basis @ weight) ** 2 for basis, weight in zip(columns, weights, strict=True)]
        best = min(errors[1:], key=lambda error: float(error[others].sum()))
        rows = [valid & (features.of_test == test) for test in tests]
        ahead += [np.log(errors[0][row].mean() / best[row].mean()) for row in rows if row.sum() >= FEWEST_BLOCKS]
    scatter = float(np.std(ahead, ddof=1)) * np.sqrt(len(ahead)) if len(ahead) > 2 else 0.0
    return float(np.sum(ahead)) / scatter if scatter > 0.0 else 0.0


def top_drivers(ranked: list[tuple[str, str, float]]) -> list[str]:
    """Return the drivers, most likely first, each once, those that explain nothing left out."""
    order: list[str] = []
    for driver, _, share in ranked:
        if share > 0 and driver not in order:
            order.append(driver)
    return order
