"""The one place where the units of log fields are converted, to SI and from the units of other loggers."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from hjcamp.errors import UsageError, unknown
from hjcamp.records.log import FIELDS

Number = TypeVar("Number", float, np.ndarray)

PASCAL_PER_MEGAPASCAL = 1e6
PUMP_DEG_PER_MM = 360.0  # lead of the pump's ball screw: 1 mm a turn

# unit of the field: {unit that may be given: factor to the field's unit}
UNITS: dict[str, dict[str, float]] = {
    "deg": {"deg": 1.0, "rad": 180.0 / math.pi, "turn": 360.0},
    "MPa": {"Pa": 1e-6, "kPa": 1e-3, "MPa": 1.0, "bar": 0.1, "psi": 6.894757293168361e-3},
    "s": {"s": 1.0, "ms": 1e-3},
    "V": {"V": 1.0, "mV": 1e-3},
    "1": {"1": 1.0},
}
# What a unit that a field cannot have measures, told in the refusal.
QUANTITIES = {
    "m": "a length", "m/s": "a speed", "m/s^2": "an acceleration", "N": "a force", "N*m": "a torque", "kg": "a mass",
    "A": "a current", "K": "a temperature", "rad/s": "a speed of turning", "m^3/s": "a flow", "Pa": "a pressure",
    "s": "a time", "V": "a voltage", "1": "a number",
}  # fmt: skip
# Fields that turn the pump may be given as the travel of its pistons.
TRAVEL: dict[str, float] = {"mm": PUMP_DEG_PER_MM}
PUMP_FIELDS: tuple[str, ...] = ("pump_deg", "command_deg", "pid_deg", "feedforward_deg")


def rad_from_deg(angle: Number) -> Number:
    """Return an angle in rad of one in deg."""
    return angle * (math.pi / 180.0)


def deg_from_rad(angle: Number) -> Number:
    """Return an angle in deg of one in rad."""
    return angle * (180.0 / math.pi)


def pa_from_mpa(pressure: Number) -> Number:
    """Return a pressure in Pa of one in MPa."""
    return pressure * PASCAL_PER_MEGAPASCAL


def mpa_from_pa(pressure: Number) -> Number:
    """Return a pressure in MPa of one in Pa."""
    return pressure / PASCAL_PER_MEGAPASCAL


def units_of(field_name: str) -> dict[str, float]:
    """Return the units in which a field may be given, with their factors to the unit of the field."""
    for field in FIELDS:
        if field.name == field_name:
            return UNITS[field.unit] | (TRAVEL if field_name in PUMP_FIELDS else {})
    raise unknown("field", field_name, [field.name for field in FIELDS])


def factor_to_field(field_name: str, unit: str, where: str) -> float:
    """Return the factor from ``unit`` to the unit of the field; raises UsageError for a unit it cannot have."""
    allowed = units_of(field_name)
    if unit in allowed:
        return allowed[unit]
    alike = [name for name in allowed if name.casefold() == unit.casefold()]
    if alike:
        raise UsageError(f"unknown unit '{unit}' of '{field_name}' in {where}; did you mean '{alike[0]}'?")
    refusal = unknown(f"unit of '{field_name}'", unit, allowed, where)
    own, other = (_quantity(one) for one in (next(iter(allowed)), unit))
    if own and other and own != other:
        raise UsageError(f"{refusal}; '{unit}' is a unit of {other}, and '{field_name}' is {own}")
    raise refusal


def _quantity(unit: str) -> str:
    """Return what a unit measures, in words; empty where it is not known."""
    import pint

    registry: pint.UnitRegistry[float] = pint.UnitRegistry()
    try:
        found = registry.parse_units(unit)
    except Exception:  # pint raises many kinds for a text that is no unit
        return ""
    angles = {registry.rad, registry.deg, registry.turn}
    names = {registry.get_dimensionality(one): words for one, words in QUANTITIES.items()}
    return "an angle" if found in angles else names.get(registry.get_dimensionality(found), "")
