"""What is fitted to a table: base parameters within what is known of them, effects, and factors of the loop."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.effects import load_effects
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.factors import FACTORS

Array = NDArray[np.float64]
#: What stands in no group and may be misprinted as well: a candidate like the factors.
CONSTANTS = ("moving_mass", "dither_gain")
#: One sigma of constants that belong to the base beside friction and lines, logarithmic: rise time to 1 ms of 17, delay to
#: half a sample of two, mass to a seventh.
TOLERANCES = {"pump_bandwidth": 0.06, "pump_latency": 0.25, "moving_mass": 0.14}
#: The same in every test of such tables, or the same thing as another parameter of its effect.
KNOWN = ("radius", "rest_before", "settled", "arm_share", "threshold")
#: One sigma of line stiffness and of factors, on a logarithmic scale: the compliance test of 4.4.3, one tube of a kind.
SPREAD = 0.35
#: The same of friction: the reference's own went up by factors of 2.4 and 4.3 over the months (4.5.1).
FRICTION_SPREAD = 1.0
#: One sigma of viscous friction, N s/m: the friction tests end at 10 mm/s, and their forces scatter by some 0.5 N.
VISCOUS_SPREAD = 50.0


@dataclass(frozen=True)
class Quantity:
    """One fitted number: its place is the logarithm of the value, or the value in ``unit``."""

    name: str
    parameter: Parameter
    spread: float = math.inf
    logarithmic: bool = False
    unit: float = 1.0

    def forth(self, value: float) -> float:
        """Return the place of ``value``."""
        return math.log(max(value, 1e-300)) if self.logarithmic else value / self.unit

    def back(self, place: float) -> float:
        """Return the value of a place, held within its bounds."""
        low, high = self.parameter.bounds
        value = math.exp(min(place, 700.0)) if self.logarithmic else place * self.unit
        return min(max(value, low), high)

    @property
    def ends(self) -> tuple[float, float]:
        """The places of its bounds."""
        low, high = self.parameter.bounds
        return self.forth(low), self.forth(high)

    @property
    def start(self) -> float:
        """The place of the published or usual value."""
        return self.forth(self.parameter.default)

    def surprise(self, place: float) -> float:
        """Return how far a place is from what is known, in sigma."""
        return (place - self.start) / self.spread


def base_quantities() -> list[Quantity]:
    """Return the base parameters; static friction as its ratio to Coulomb friction, which is at least 1."""
    found = []
    for name in PumpJoint.base_parameters:
        parameter = PumpJoint.parameters[name]
        if name.startswith("static_"):
            side = name.removeprefix("static_")
            ratio = parameter.default / PumpJoint.parameters[f"coulomb_{side}"].default
            found.append(Quantity(f"drop_{side}", Parameter("1", ratio, (1.0, 4.0)), SPREAD))
        elif name.startswith("viscous_"):
            found.append(Quantity(name, parameter, 1.0, unit=VISCOUS_SPREAD))
        else:
            spread = FRICTION_SPREAD if name.startswith("coulomb_") else SPREAD
            found.append(Quantity(name, parameter, spread, logarithmic=True))
    return found + [Quantity(name, _constant(name), spread, True) for name, spread in TOLERANCES.items()]


def _constant(name: str) -> Parameter:
    return FACTORS.get(name) or PumpJoint.parameters[name]


def candidate_quantities(name: str) -> list[Quantity]:
    """Return what a candidate adds to the base: one factor or constant, or the parameters of one effect."""
    if name in FACTORS or name in CONSTANTS:
        parameter = _constant(name)
        return [Quantity(name, parameter)] if parameter.off is not None else [Quantity(name, parameter, SPREAD, True)]
    found = []
    for key, parameter in load_effects()[name].parameters.items():
        if key not in KNOWN:
            low, high = parameter.bounds
            unit = abs(parameter.default) or 0.1 * (high - low)
            free = Quantity(f"{name}.{key}", parameter, logarithmic=parameter.prior == "log-uniform", unit=unit)
            found.append(free)
    return found


def candidates() -> dict[str, Any]:
    """Return all that may be missing by name: every effect, then the factors of the loop and the open constants."""
    constants = {name: _constant(name) for name in (*FACTORS, *CONSTANTS)}
    return {**dict(sorted(load_effects().items())), **constants}


def quantities_of(names: Sequence[str]) -> list[Quantity]:
    """Return the base quantities and those of the named candidates; one that the base has within its tolerance is freed."""
    return [one for one in base_quantities() if one.name not in names] + [
        one for name in names for one in candidate_quantities(name)
    ]


def settings_of(quantities: Sequence[Quantity], places: Array) -> dict[str, float]:
    """Return the settings of a rig for these places; static friction from its ratio."""
    found = {one.name: one.back(float(place)) for one, place in zip(quantities, places, strict=True)}
    for side in ("positive", "negative"):
        if (ratio := found.pop(f"drop_{side}", None)) is not None:
            found[f"static_{side}"] = ratio * found[f"coulomb_{side}"]
    return found


def surprise(quantities: Sequence[Quantity], places: Array) -> float:
    """Return the squared distance of the quantities from what is known, in units of their spread."""
    return float(sum(one.surprise(float(place)) ** 2 for one, place in zip(quantities, places, strict=True)))


def model_of(settings: Mapping[str, float]) -> dict[str, dict[str, object]]:
    """Return settings as a saved model has them: plant parameters, effects and factors."""
    model: dict[str, dict[str, object]] = {"parameters": {}, "effects": {}, "factors": {}}
    for name, value in settings.items():
        effect, dot, key = name.partition(".")
        if dot:
            given = model["effects"].setdefault(effect, {})
            assert isinstance(given, dict)
            given[key] = value
        else:
            model["factors" if name in FACTORS else "parameters"][name] = value
    return model
