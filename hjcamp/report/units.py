"""The units in which people read parameters: the one place where SI numbers of answers become readable ones."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hjcamp.known_plants import usual_plant

# SI unit: (unit that is shown, factor from SI to it). Units that are not here are shown as they are.
SHOWN: dict[str, tuple[str, float]] = {
    "1": ("", 1.0),
    "rad": ("deg", 180.0 / math.pi),
    "m": ("mm", 1e3),
    "m^2": ("mm2", 1e6),
    "m^3": ("mm3", 1e9),
    "m^3/s": ("mm3/s", 1e9),
    "m/s": ("mm/s", 1e3),
    "m/s^2": ("mm/s2", 1e3),
    "kg": ("g", 1e3),
    "Pa": ("MPa", 1e-6),
    "Pa/m^3": ("MPa/mm3", 1e-15),
    "Pa*s/m^3": ("kPa s/mm3", 1e-12),
    "kg/m^4": ("Pa s2/mm3", 1e-9),
    "m^3/(s*Pa)": ("mm3/(s MPa)", 1e15),
    "m/N": ("mm/N", 1e3),
    "N/m": ("N/mm", 1e-3),
    "N/Pa": ("N/MPa", 1e6),
    "N*s/m": ("N s/mm", 1e-3),
    "rad/V": ("deg/V", 180.0 / math.pi),
    "m/rad": ("mm/rad", 1e3),
}


def shown(value: float, unit: str) -> tuple[float, str]:
    """Return an SI value and its unit as people read them; a number without unit has the unit ''."""
    name, factor = unit_for(value, unit)
    return value * factor, name


def unit_for(value: float, unit: str) -> tuple[str, float]:
    """Return the unit in which a value of this size is read, and the factor to it.

    A kilogram or more stays as it is, and so does less than a kilopascal, and what would have more than four digits before
    its point in the smaller unit, or a zero behind it in the larger one, where it needs no exponent in SI.
    """
    if (unit == "kg" and abs(value) >= 1.0) or (unit == "Pa" and 0.0 < abs(value) < 1e3):
        return unit, 1.0
    name, factor = SHOWN.get(unit, (unit, 1.0))
    if unit == "Pa":
        return SHOWN[unit]
    shown_well = 1e-4 <= abs(value) < 1e4
    large, small = factor > 1.0 and abs(value) * factor >= 1e4, factor < 1.0 and abs(value) * factor < 0.1
    return (unit, 1.0) if shown_well and (large or small) else (name, factor)


def told(value: float, unit: str, digits: int = 3) -> str:
    """Return an SI value with the unit that people read: ``0.279 mm3/(s MPa)``."""
    number, name = shown(value, unit)
    return f"{plain(number, digits)} {name}".rstrip()


def told_interval(row: Mapping[str, Any], digits: int = 3) -> str:
    """Return the 95 % interval of one row of an answer (value, unit, ci95): ``0.268 to 0.29``; in words where nothing tells it."""
    if not row.get("told", True):
        return "not told by these tests"
    factor = unit_for(row.get("value", row["ci95"][1]), row["unit"])[1]
    low, high = (one * factor for one in row["ci95"])
    while digits < 7 and low != high and plain(low, digits) == plain(high, digits):
        digits += 1
    return f"{plain(low, digits)} to {plain(high, digits)}"


def plain(number: float, digits: int = 3) -> str:
    """Return a number with so many digits, without an exponent where it is neither very large nor very small."""
    if number and math.isfinite(number) and 1e-4 <= abs(number) < 1e7:
        places = max(digits - 1 - math.floor(math.log10(abs(number))), 0)
        text = f"{number:.{places}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    return f"{number:.{digits}g}"


def label(name: str) -> str:
    """Return the name of a parameter or channel as people read it: ``coulomb_positive`` is ``Coulomb, positive``."""
    for direction in ("positive", "negative"):
        kind = name.removesuffix(f"_{direction}")
        if kind in FRICTION and kind != name:
            return f"{FRICTION[kind]} friction, {direction}"
    return usual_plant().labels.get(name, name.replace("_", " "))


FRICTION = {"static": "static", "coulomb": "Coulomb", "viscous": "viscous"}
