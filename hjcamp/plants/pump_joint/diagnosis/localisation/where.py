"""Where the error comes from: the cut between subsystems, then residual force and flow in bins of what was measured."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.localisation.drivers import driver_values
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import DEGREE
from hjcamp.plants.pump_joint.diagnosis.residuals.features import BLOCK, Features
from hjcamp.plants.pump_joint.diagnosis.residuals.replay import Replay

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
WINDOW, SUM, DIFFERENCE, SLIDING, BREAKAWAY = 1, 2, 3, 4, 5
SLOPE = 10
FEWEST = 5
UNITS = {
    "arm_angle": ("deg", 1 / DEGREE),
    "arm_velocity": ("mm/s", 1e3),
    "pressure_sum": ("MPa", 1e-6),
    "pump_velocity": ("mm/s", 1.0 / (2 * np.pi)),
    "time": ("s", 1.0),
    "time_at_rest": ("s", 1.0),
}
DIRECTIONS = {1.0: "positive", -1.0: "negative", 0.0: "at rest"}
VARIABLES = {
    "joint": ("direction", "arm_velocity", "arm_angle", "pressure_sum", "time", "repetition"),
    "lines": ("direction", "pressure_sum", "pump_velocity", "arm_angle", "time", "repetition"),
}


@dataclass(frozen=True)
class Place:
    """A share of the error above repeatability: subsystem, variable and bin, z against the repetitions, conditions that show it.

    Of ``total`` conditions ``conditions`` have moments in the bin, and in ``shown`` of those the mean has the sign of z: that of
    model - measured in a bin, + where the error is above that of repetitions for a subsystem as a whole.
    """

    subsystem: str
    variable: str
    bin: str
    share: float
    z: float
    shown: int = 0
    conditions: int = 0
    total: int = 0

    def row(self) -> dict[str, object]:
        """Return the row of the answer."""
        return {
            "subsystem": self.subsystem,
            "variable": self.variable,
            "bin": self.bin,
            "share": round(float(self.share), 4),
            "z": round(float(self.z), 2),
        }


@dataclass(frozen=True)
class Quantity:
    """A residual (blocks,) in its own unit, where it says something, and the driver values of its blocks."""

    subsystem: str
    values: Array
    valid: Bools
    drivers: dict[str, Array]
    variables: tuple[str, ...]


def subsystem_excess(features: Features, seen: Array, noise_floor: Array, replayed: Replay | None) -> dict[str, float]:
    """Return the mean square excess over the floor of pump, lines and joint, all as a pressure difference (Pa^2).

    Lines: driven by measured pump and arm. Joint: force balance with every state measured, over the piston area.
    Pump: its own model driven by the command, as the pressure that the missing volume would make; 0 without a replay.
    """
    values = features.evidence.tests[0].hardware.values
    valid = features.valid
    mean = (seen**2).sum(axis=0) / np.maximum(valid.sum(axis=0), 1)
    excess = np.maximum(mean - noise_floor**2, 0.0)
    numbers = valid[:, [SLIDING, BREAKAWAY]].sum(axis=0)
    force = float((excess[[SLIDING, BREAKAWAY]] * numbers).sum() / max(numbers.sum(), 1))
    found = {"lines": float(excess[SUM] + excess[DIFFERENCE]), "joint": force / values["joint_area"] ** 2, "pump": 0.0}
    # Windows follow the pump alone: what they lack beyond the line cut and the force balance is born in the joint.
    found["joint"] = max(found["joint"], float(excess[WINDOW]) - found["lines"])
    error = None if replayed is None else replayed.errors["pump_deg"]
    if error is not None:
        volume = values["pump_area"] * values["pump_lead"] * DEGREE
        lost = max(error.rms**2 - (error.noise_floor or 0.0) ** 2, 0.0)
        found["pump"] = lost * (2 * values["line_stiffness"] * volume) ** 2
    return found


def where(features: Features, seen: Array, noise_floor: Array | None, replayed: Replay | None) -> list[Place]:
    """Return the places of the error above repeatability, largest share first: subsystems as a whole, then their bins.

    ``seen`` (blocks, channels) are the features of the model's residuals, ``floor`` (channels,) that of the logs. The share
    of a bin is what its mean residual explains of its subsystem's share. A subsystem whose error is not above its floor
    (z below 2) is left out.
    """
    if noise_floor is None:
        noise_floor = np.zeros(seen.shape[1])
    excess = subsystem_excess(features, seen, noise_floor, replayed)
    total = sum(excess.values()) or 1.0
    places = []
    for subsystem, value in excess.items():
        if value / total > 0.005:
            z, shown, number = _significance(features, _level(features, seen, noise_floor, subsystem, replayed))
            places.append(Place(subsystem, "all", "all", value / total, z, shown, number))
    every = quantities(features, seen)
    for quantity in every:
        share = excess[quantity.subsystem] / total
        if share > 0.01:
            similar = [one for one in every if one.subsystem == quantity.subsystem]
            whole = sum(float((one.values[one.valid] ** 2).sum()) for one in similar)
            places += _bins(features, quantity, share / (whole or 1.0))
    places = _merged(places)
    seen_in = {place.subsystem for place in places if place.variable == "all" and place.z > 2.0}
    kept = [
        replace(place, total=len(features.evidence.conditions))
        for place in places
        if place.subsystem in seen_in and (place.variable == "all" or (place.share >= 0.01 and abs(place.z) > 2.0))
    ]
    return sorted(kept, key=lambda place: (-place.share, place.variable != "all"))[:40]


def _merged(places: list[Place]) -> list[Place]:
    """Return places of one subsystem, variable and bin as one: line sum and difference share theirs; the larger z."""
    found: dict[tuple[str, str, str], Place] = {}
    for place in places:
        other = found.get(key := (place.subsystem, place.variable, place.bin))
        if other is not None:
            larger = max(place, other, key=lambda one: abs(one.z))
            place = replace(larger, share=place.share + other.share)
        found[key] = place
    return list(found.values())


def quantities(features: Features, seen: Array) -> list[Quantity]:
    """Return what is binned: the force while sliding and at breakaway, and the rate of the line errors (a flow)."""
    drivers = driver_values(features)
    rest = drivers["time_at_rest"]
    before = np.maximum(np.roll(rest, 1), np.maximum(rest, np.roll(rest, 2)))
    valid = features.valid
    slopes, whole = _slopes(features, seen[:, [SUM, DIFFERENCE]])
    plain = {name: column for name, column in drivers.items() if name != "time_at_rest"}
    return [
        Quantity("joint", seen[:, SLIDING], valid[:, SLIDING], plain, VARIABLES["joint"]),
        Quantity("joint", seen[:, BREAKAWAY], valid[:, BREAKAWAY], {"time_at_rest": before, **plain}, ("time_at_rest",)),
        Quantity("lines", slopes[:, 0], whole, plain, VARIABLES["lines"]),
        Quantity("lines", slopes[:, 1], whole, plain, VARIABLES["lines"][2:]),
    ]


def _slopes(features: Features, values: Array) -> tuple[Array, Bools]:
    """Return the centred differences (blocks, k) over 2 SLOPE blocks inside each test, Pa/s, and where they are whole."""
    out, whole = np.zeros_like(values), np.zeros(len(values), dtype=np.bool_)
    for begin, end in zip(features.edges[:-1], features.edges[1:], strict=True):
        if end - begin > 2 * SLOPE:
            out[begin + SLOPE : end - SLOPE] = values[begin + 2 * SLOPE : end] - values[begin : end - 2 * SLOPE]
            whole[begin + SLOPE : end - SLOPE] = True
    return out / (2 * SLOPE * BLOCK * 4e-3), whole


def _level(features: Features, seen: Array, noise_floor: Array, subsystem: str, replayed: Replay | None) -> Array:
    """Return for each test by how much its mean square is above the floor, in floors; NaN where nothing is seen."""
    tests = len(features.evidence.tests)
    if subsystem == "pump" and replayed is not None:
        error = replayed.errors["pump_deg"]
        least = (error.noise_floor if error is not None else None) or 0.0
        squares = {index: float(np.mean(one**2)) for index, one in replayed.pump.items()}
        return np.array([_above(squares.get(index, np.nan), least) for index in range(tests)])
    channels = [SUM, DIFFERENCE] if subsystem == "lines" else [WINDOW, SLIDING, BREAKAWAY]
    numbers = np.add.reduceat(features.valid.astype(float), features.edges[:-1], axis=0)[:, channels]
    squares_seen = features.mean_square(seen)[:, channels]
    above = np.column_stack([_above(squares_seen[:, k], noise_floor[channel]) for k, channel in enumerate(channels)])
    total = numbers.sum(axis=1)
    return np.where(total > 0, (above * numbers).sum(axis=1) / np.maximum(total, 1), np.nan)


def _above(square: Any, least: float) -> Any:
    return square / least**2 - 1.0 if least > 0 else square


def _significance(features: Features, level: Array) -> tuple[float, int, int]:
    """Return z of the mean of a test-wise level (NaN: not seen), the conditions that share its sign, their number.

    The scatter is that between repetitions of a condition, or between all tests where nothing was repeated.
    """
    squares, freedom, means = 0.0, 0, []
    for tests in features.evidence.conditions.values():
        values = level[tests]
        values = values[np.isfinite(values)]
        if len(values):
            means.append(float(values.mean()))
            squares += float(((values - values.mean()) ** 2).sum())
            freedom += len(values) - 1
    every = level[np.isfinite(level)]
    if len(every) < 2:
        return 0.0, 0, len(means)
    deviation = np.sqrt(squares / freedom) if freedom > 0 else float(np.std(every, ddof=1))
    error = deviation / np.sqrt(len(every))
    mean = float(every.mean())
    z = mean / error if error > 0 else 0.0
    similar = sum(1 for one in means if one * mean > 0)
    return float(np.clip(z, -999.0, 999.0)), similar, len(means)


def _bins(features: Features, quantity: Quantity, weight: float) -> list[Place]:
    """Return the bins of one quantity; ``weight`` is the share of the excess for one squared unit of it."""
    found = []
    signs = quantity.drivers["direction"]
    for variable in quantity.variables:
        for label, inside in bins_of(variable, quantity.drivers[variable], signs, quantity.valid):
            level = _test_means(features, quantity.values, inside)
            z, shown, number = _significance(features, level)
            mean = float(quantity.values[inside].mean())
            part = weight * float(inside.sum()) * mean**2
            found.append(Place(quantity.subsystem, variable, label, part, z, shown, number))
    return found


def _test_means(features: Features, values: Array, inside: Bools) -> Array:
    count = len(features.evidence.tests)
    numbers = np.bincount(features.of_test[inside], minlength=count)
    sums = np.bincount(features.of_test[inside], weights=values[inside], minlength=count)
    return np.where(numbers > 0, sums / np.maximum(numbers, 1), np.nan)


def bins_of(variable: str, values: Array, signs: Array, valid: Bools) -> list[tuple[str, Bools]]:
    """Return the bins of a variable as (label, blocks inside), each direction of motion on its own."""
    if variable == "direction":
        bins = [(label, valid & (signs == sign)) for sign, label in DIRECTIONS.items()]
    elif variable == "repetition":
        bins = [(f"{number + 1:.0f}", valid & (values == number)) for number in np.unique(values)]
    else:
        bins = []
        unit, scale = UNITS[variable]
        edges = nice_edges(values[valid] * scale) if valid.any() else []
        for low, high in pairwise(edges):
            part = valid & (values * scale >= low) & (values * scale < high)
            for sign, label in DIRECTIONS.items():
                bins.append((f"{label}, {low:g} to {high:g} {unit}", part & (signs == sign)))
    return [(label, inside) for label, inside in bins if inside.sum() >= FEWEST]


def nice_edges(values: Array, wanted: int = 5) -> list[float]:
    """Return about ``wanted`` + 1 round edges that hold all values (1, 2, 5 times a power of ten apart)."""
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return [low, np.nextafter(low, np.inf)]
    rough = (high - low) / wanted
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * min((1.0, 2.0, 5.0, 10.0), key=lambda one: abs(one * power - rough))
    first, last = np.floor(low / step), np.floor(high / step) + 1
    return [float(f"{number * step:.6g}") for number in np.arange(first, last + 1)]
