"""What the best model leaves, as a curve: unexplained force or flow over the driver that it most likely depends on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
from hjcamp.plants.pump_joint.diagnosis.localisation.drivers import driver_values
from hjcamp.plants.pump_joint.diagnosis.localisation.where import FEWEST, UNITS, quantities
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features

Array = NDArray[np.float64]
MORE_UNITS = {"pressure_difference": ("MPa", 1e-6), "pump_position": ("mm", 1.0 / (2 * np.pi))}
# channel of the ranking: position among the quantities of "where", what it is, its unit
CHANNELS = {
    "sliding": (0, "force on the arm", "N"),
    "line_sum": (2, "flow out of both lines", "mm3/s"),
    "line_difference": (3, "flow out of line 1 beyond that of line 2", "mm3/s"),
}
SI = {"": 1.0, "deg": np.pi / 180.0, "mm": 1e-3, "mm/s": 1e-3, "MPa": 1e6, "s": 1.0, "N": 1.0, "mm3/s": 1e-9}
IN_SI = {"deg": "rad", "mm": "m", "mm/s": "m/s", "MPa": "Pa", "mm3/s": "m^3/s"}
BINS = 12
STRAIGHT = 0.5


@dataclass(frozen=True)
class Unexplained:
    """A mean force (N) or flow (mm3/s) over bins of a driver (bins,), moving forwards and backwards; NaN where not seen.

    ``gain`` is the share of the residual that the driver tells on conditions left out; ``spread`` (bins,) the standard error of the
    mean of both directions, from test to test.
    """

    driver: str
    driver_unit: str
    quantity: str
    unit: str
    centres: Array
    forward: Array
    backward: Array
    channel: str = "sliding"
    gain: float = 0.0
    spread: Array | None = None

    def row(self) -> dict[str, Any]:
        """Return the curve for programs, SI: what drives it, where it acts, and its values in both directions."""
        both = np.where(np.isnan(self.forward), self.backward, np.where(np.isnan(self.backward), self.forward, self.even))
        wide = 1.96 * (np.full(len(both), np.nan) if self.spread is None else self.spread)
        forward, backward, y, low, high = (
            [float(value) * SI[self.unit] if np.isfinite(value) else None for value in one]
            for one in (self.forward, self.backward, both, both - wide, both + wide)
        )
        return {
            "driver": self.driver, "quantity": self.quantity, "port": self.channel, "gain": self.gain,
            "curve": {
                "x": [float(v) * SI[self.driver_unit] for v in self.centres], "y": y, "low": low, "high": high,
                "forward": forward, "backward": backward,
                "x_unit": IN_SI.get(self.driver_unit, self.driver_unit) or "1", "y_unit": IN_SI.get(self.unit, self.unit),
            },
        }  # fmt: skip

    @property
    def even(self) -> Array:
        """What does not know the direction of motion (bins,), like a spring."""
        return 0.5 * (self.forward + self.backward)

    @property
    def odd(self) -> Array:
        """What turns with the direction of motion (bins,), like friction."""
        return 0.5 * (self.forward - self.backward)

    def sentence(self, model: str) -> str:
        """Return what ``model`` lacks in words: the slope of the curve where it is straight, else its range."""
        parts = {"": self.even, " and turns with the direction of motion": self.odd}
        kind, curve = max(parts.items(), key=lambda item: float(np.ptp(_seen(item[1]))) if _seen(item[1]).size else -1.0)
        if not _seen(curve).size:
            kind, curve = "", np.where(np.isfinite(self.forward), self.forward, self.backward)
        name = self.driver.replace("_", " ")
        said = f"What the {model} model lacks is a {self.quantity} that depends on {name}{kind}"
        inside = np.isfinite(curve)
        if inside.sum() < 3:
            return f"{said}."
        slope, level = np.polyfit(self.centres[inside], curve[inside], 1)
        rest = float(np.var(curve[inside] - slope * self.centres[inside] - level))
        if slope and rest < (1.0 - STRAIGHT) * float(np.var(curve[inside])):
            each = f"{self.unit}/{self.driver_unit}" if self.driver_unit else self.unit
            return f"{said}: about {slope:.2g} {each}."
        low, high = float(curve[inside].min()), float(curve[inside].max())
        return f"{said}: between {low:.2g} and {high:.2g} {self.unit}."


def unexplained(features: Features, fit: Fit, driver: str, channel: str, gain: float = 0.0) -> Unexplained:
    """Return what ``fit`` leaves over ``driver`` in the ``channel``; ``gain`` is the share of it that the driver tells."""
    index, name, unit = CHANNELS[channel]
    quantity = quantities(features, fit.features)[index]
    # The balance is push less friction: a force on the arm that the model lacks has the other sign.
    scale = -1.0 if channel == "sliding" else 1e9 / fit.candidate.base["line_stiffness"]
    drivers = driver_values(features)
    driver_unit, factor = {**UNITS, **MORE_UNITS}.get(driver, ("", 1.0))
    values, sign = drivers[driver] * factor, drivers["direction"]
    edges = _edges(values[quantity.valid])
    curves = []
    for inside in (quantity.valid & (sign > 0), quantity.valid & (sign < 0)):
        members = [inside & (values >= low) & (values < high) for low, high in pairwise(edges)]
        curves.append(
            np.array([scale * float(quantity.values[one].mean()) if one.sum() >= FEWEST else np.nan for one in members])
        )
    of_bin = np.where(quantity.valid, np.digitize(values, edges) - 1, -1)
    spread = np.array([scale * _error_of_mean(quantity.values, features.of_test, of_bin == k) for k in range(len(edges) - 1)])
    return Unexplained(
        driver, driver_unit, name, unit, 0.5 * (edges[1:] + edges[:-1]), curves[0], curves[1], channel, gain, np.abs(spread)
    )


def _error_of_mean(values: Array, of_test: NDArray[np.int64], inside: NDArray[np.bool_]) -> float:
    """Return the standard error of a mean over blocks, as the means of tests tell it; NaN for a single test."""
    means = [float(values[inside & (of_test == test)].mean()) for test in np.unique(of_test[inside])]
    return float(np.std(means, ddof=1) / np.sqrt(len(means))) if len(means) > 1 else float("nan")


def driver_of(features: Features, fit: Fit, channel: str, barred: Sequence[str] = ()) -> str:
    """Return the driver whose bins, each direction on its own, tell most of what ``fit`` leaves in a channel."""
    quantity = quantities(features, fit.features)[CHANNELS[channel][0]]
    drivers = driver_values(features)
    valid, sign = quantity.valid, drivers["direction"]
    whole = float(np.sum((quantity.values[valid] - quantity.values[valid].mean()) ** 2)) if valid.any() else 0.0
    told: dict[str, float] = {}
    for name, values in drivers.items():
        if name in barred or name in ("repetition", "direction") or whole == 0.0:
            continue
        left = 0.0
        for way in (1.0, 0.0, -1.0):
            inside = valid & (sign == way)
            place = np.digitize(values, _edges(values[valid]))
            for one in np.unique(place[inside]):
                members = quantity.values[inside & (place == one)]
                left += float(np.sum((members - members.mean()) ** 2))
        told[name] = 1.0 - left / whole
    return max(told, key=lambda name: told[name]) if told else "time"


def _edges(values: Array) -> Array:
    """Return the edges of the bins: each value on its own where there are few, else even steps."""
    distinct = np.unique(values)
    if 0 < len(distinct) <= 6:
        steps = 0.5 * (distinct[1:] + distinct[:-1])
        return np.concatenate([[distinct[0] - 1.0], steps, [distinct[-1] + 1.0]])
    low, high = np.quantile(values, [0.005, 0.995]) if len(values) else (0.0, 1.0)
    return np.asarray(np.linspace(low, high if high > low else low + 1.0, BINS + 1))


def _seen(curve: Array) -> Array:
    return curve[np.isfinite(curve)]
