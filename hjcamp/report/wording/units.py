"""The units in which people read parameters: the one place where SI numbers of answers become readable ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.errors import plain
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


#: Of an estimate that is known ever so well.
MOST_DIGITS = 7


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


def estimate_texts(row: Mapping[str, Any], digits: int = 3) -> tuple[str, tuple[str, str] | None, str]:
    """Return the value, the ends of the interval (None: not known) and the unit of one row of an answer (value, unit, ci95).

    All are rounded to the same decimals, with which half the interval has two digits. Rounding keeps the order of numbers, so
    a value is never shown outside its own interval. Without an interval the value has ``digits`` digits.
    """
    factor, name = _unit_of(row)
    ends = row.get("ci95") or (None, None)
    value = float(row["value"] if "value" in row else row["ci95"][1])
    if None in ends or not row.get("told", True):
        return plain(value * factor, digits), None, name
    low, high = (float(end) * factor for end in row["ci95"])
    places = decimals_of(0.5 * abs(high - low), value * factor)
    texts = [plain(one, digits) if places is None else rounded(one, places) for one in (value * factor, low, high)]
    return texts[0], (texts[1], texts[2]), name


def told_estimate(row: Mapping[str, Any], digits: int = 3) -> str:
    """Return the value of one row of an answer as its interval allows, with its unit: ``0.279 mm3/(s MPa)``."""
    value, _, name = estimate_texts(row, digits)
    return f"{value} {name}".rstrip()


def told_like(value: float, row: Mapping[str, Any], digits: int = 3) -> str:
    """Return another value of the same quantity (what was published of it) in the unit that `told_estimate` shows."""
    return f"{number_like(value, row, digits)} {_unit_of(row)[1]}".rstrip()


def told_all(values: Sequence[float], unit: str, digits: int = 3) -> list[str]:
    """Return SI values of one quantity in one unit, that in which the largest of them is read."""
    most = {"value": max((abs(value) for value in values if math.isfinite(value)), default=0.0), "unit": unit}
    return [told_like(value, most, digits) for value in values]


def number_like(value: float, row: Mapping[str, Any], digits: int = 3) -> str:
    """Return `told_like` without its unit."""
    return plain(value * _unit_of(row)[0], digits)


def told_interval(row: Mapping[str, Any]) -> str:
    """Return the 95 % interval of one row of an answer (value, unit, ci95): ``0.268 to 0.290``; in words where nothing tells it."""
    ends = estimate_texts(row)[1]
    return "not identifiable from these tests" if ends is None else " to ".join(ends)


def told_error(value: float, error: float, unit: str) -> str:
    """Return a value and its standard error with the same decimals, two digits of the error: ``80.0000 ± 0.0035 kg``."""
    factor, name = _unit_of({"value": value, "unit": unit})
    places = decimals_of(abs(error * factor), value * factor)
    texts = [plain(value * factor), plain(abs(error * factor), 2)]
    if places is not None:
        texts = [rounded(value * factor, places), rounded(abs(error * factor), places)]
    return f"{texts[0]} ± {texts[1]} {name}".rstrip()


def decimals_of(uncertainty: float, value: float = 0.0, digits: int = 2) -> int | None:
    """Return the decimals that show an uncertainty with so many digits (negative: tens, hundreds); None where there is none.

    No more than ``MOST_DIGITS`` digits of the value are shown.
    """
    if not (uncertainty > 0.0 and math.isfinite(uncertainty)):
        return None
    exponent = math.floor(math.log10(uncertainty))
    if round(uncertainty / 10.0 ** (exponent - digits + 1)) >= 10**digits:  # 0.0996 has the digits of 0.10
        exponent += 1
    most = MOST_DIGITS - 1 - math.floor(math.log10(abs(value))) if value else math.inf
    return int(min(digits - 1 - exponent, most))


def rounded(number: float, places: int) -> str:
    """Return a number with so many decimals; one that would be shown as nothing keeps two digits of its own.

    The order of numbers is kept: what is rounded to nothing is below half a step, what is not is at least one.
    """
    near = round(number, places)
    if not near and number:
        return plain(number, 2)
    size = abs(near)
    if size >= 1e7 or (near and size < 1e-4 and places > 6):
        return f"{near:.{max(math.floor(math.log10(size)) + places, 0)}e}"
    return f"{near:.{max(places, 0)}f}"


def _unit_of(row: Mapping[str, Any]) -> tuple[float, str]:
    name, factor = unit_for(row.get("value", (row.get("ci95") or (0.0, 0.0))[1]), row["unit"])
    return factor, name


def label(name: str) -> str:
    """Return the name of a parameter or channel as people read it: ``coulomb_positive`` is ``Coulomb, positive``."""
    for direction in ("positive", "negative"):
        kind = name.removesuffix(f"_{direction}")
        if kind in FRICTION and kind != name:
            return f"{FRICTION[kind]} friction, {direction}"
    return usual_plant().labels.get(name, name.replace("_", " "))


FRICTION = {"static": "static", "coulomb": "Coulomb", "viscous": "viscous"}
