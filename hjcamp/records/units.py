"""The one place where the units of log fields are converted, to SI and from the units of other loggers."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.field import Field
from hjcamp.model.language.field_unit import FIELD_UNITS, unit_shown

# Units that no field is named by, though people measure in them: their size in SI.
RELATIVES: dict[str, dict[str, float]] = {
    "s": {"us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "day": 86400.0},
    "m": {"um": 1e-6, "cm": 1e-2, "km": 1e3, "in": 0.0254},
    "m/s": {"cm/s": 1e-2, "um/s": 1e-6, "km/h": 1.0 / 3.6, "m/min": 1.0 / 60.0},
    "m/s^2": {"mm/s^2": 1e-3, "g": 9.80665},
    "rad/s": {"turn/s": 2.0 * math.pi},
    "N": {"mN": 1e-3, "kN": 1e3, "kgf": 9.80665, "lbf": 4.4482216152605},
    "N*m": {"kN m": 1e3, "N mm": 1e-3},
    "Pa": {"psi": 6894.757293168361, "mbar": 100.0, "hPa": 100.0, "GPa": 1e9},
    "kg": {"mg": 1e-6, "t": 1e3},
    "kg/s": {
        "mg/s": 1e-6, "mg/min": 1e-6 / 60.0, "mg/h": 1e-6 / 3600.0, "g/min": 1e-3 / 60.0, "g/h": 1e-3 / 3600.0,
        "kg/min": 1.0 / 60.0, "kg/h": 1.0 / 3600.0, "t/h": 1e3 / 3600.0,
    },
    "kg/m^3": {"mg/L": 1e-3, "ug/L": 1e-6, "mg/mL": 1.0, "ug/mL": 1e-3, "g/mL": 1e3, "g/cm^3": 1e3, "kg/L": 1e3},
    "mol/m^3": {"mmol/L": 1.0, "umol/L": 1e-3},
    "m^3": {"mL": 1e-6, "cm^3": 1e-6, "mm^3": 1e-9},
    "m^3/s": {
        "L/s": 1e-3, "L/h": 1e-3 / 3600.0, "mL/min": 1e-6 / 60.0, "mL/s": 1e-6, "m^3/h": 1.0 / 3600.0,
        "cm^3/s": 1e-6, "mm^3/s": 1e-9,
    },
    "V": {"kV": 1e3, "uV": 1e-6},
    "A": {"uA": 1e-6, "kA": 1e3},
    "W": {"mW": 1e-3, "kW": 1e3},
    "K": {"mK": 1e-3, "degC": 1.0, "degF": 5.0 / 9.0},
    "1": {"ppm": 1e-6},
}  # fmt: skip
# What is added to a value in such a unit before its size counts.
SHIFTS = {"degC": 273.15, "degF": 459.67}
# The same unit written in another way.
SIGNS = str.maketrans({"µ": "u", "μ": "u", "°": "deg", "³": "^3", "²": "^2", "Ω": "ohm", "⋅": "*"})
LONGEST_UNIT = 40
# What would take pint long to compute is no unit.
POWER_OF_POWER = re.compile(
    r"(?:\^|\*\*)\s*(?!-?\d(?:\.\d)?(?![\d.^*]|\s*(?:\^|\*\*)))|\d\s*(?:\^|\*\*).*\d\s*(?:\^|\*\*)|e\d\d"
)
UNIT_TEXT = re.compile(r"[A-Za-z0-9_%*/^(). -]+")
WRITTEN = str.maketrans({"µ": "u", "μ": "u", "°": "deg", "³": "^3", "²": "^2", "·": "", "*": "", " ": ""})
ALIASES = {
    "percent": "%", "ratio": "1", "-": "1", "sec": "s", "d": "day", "days": "day",
    "rev": "turn", "rev/s": "turn/s", "rev/min": "rpm", "l": "L",
    "l/min": "L/min", "l/s": "L/s", "l/h": "L/h", "ml": "mL", "ml/min": "mL/min", "ml/s": "mL/s",
}  # fmt: skip
# What a unit that a field cannot have measures, told in the refusal.
QUANTITIES = {
    "m": "a length", "m/s": "a speed", "m/s^2": "an acceleration", "N": "a force", "N*m": "a torque", "kg": "a mass",
    "A": "a current", "K": "a temperature", "rad/s": "a speed of turning", "m^3/s": "a flow", "Pa": "a pressure",
    "rad": "an angle", "s": "a time", "V": "a voltage", "W": "a power", "m^3": "a volume", "1": "a number",
    "kg/s": "a flow of mass", "kg/m^3": "a concentration",
}  # fmt: skip


@dataclass(frozen=True)
class Conversion:
    """A value in the field's unit is ``(value + shift) * factor``."""

    factor: float
    shift: float = 0.0


def units_of(field: Field) -> dict[str, Conversion]:
    """Return the units in which a field may be given, its own first, with their conversions to it."""
    return _units_of(field.unit) | {unit: Conversion(size) for unit, size in field.also}


@cache
def _units_of(shown: str) -> dict[str, Conversion]:
    own = unit_shown(shown)
    same_si = {unit.shown: own.scale / unit.scale for unit in FIELD_UNITS.values() if unit.si == own.si}
    relatives = {unit: size * own.scale for unit, size in RELATIVES.get(own.si, {}).items()}
    sizes = {shown: 1.0} | same_si | relatives
    return {unit: Conversion(size, SHIFTS.get(unit, 0.0)) for unit, size in sizes.items()}


def conversion_to_field(field: Field, unit: str, where: str) -> Conversion:
    """Return the conversion from ``unit``, one of ours or any that pint knows, to the unit of the field.

    An angle is a dimension of its own: a number of turns is none of radians. Raises UsageError for a unit of another dimension,
    one that is not proportional to the field's (a decibel), and one that nobody knows; it names the nearest.
    """
    allowed = units_of(field)
    same = {name.translate(WRITTEN): name for name in reversed(allowed)}
    if (known := same.get(ALIASES.get(unit, unit).translate(WRITTEN))) is not None:
        return allowed[known]
    found = _converted(unit, field.unit)
    if isinstance(found, Conversion):
        return found
    similar = [name for name in allowed if name.casefold() == unit.casefold()]
    if similar:
        raise UsageError(f"unknown unit '{unit}' of '{field.name}' in {where}; did you mean '{similar[0]}'?")
    refusal = unknown(f"unit of '{field.name}'", unit, allowed, where)
    raise UsageError(f"{refusal}; '{unit}' {found}, and '{field.name}' is {_quantity(field.unit)}") if found else refusal


def is_unit(text: str) -> bool:
    """Whether a text is a unit that an import can convert from."""
    return is_own_unit(text) or _parsed(text) is not None


def is_own_unit(text: str) -> bool:
    """Whether a text is a unit of our own table."""
    return text.translate(WRITTEN) in _own_units()


@cache
def _own_units() -> frozenset[str]:
    shown = {unit.shown for unit in FIELD_UNITS.values()} | {name for one in RELATIVES.values() for name in one} | {*ALIASES}
    return frozenset(name.translate(WRITTEN) for name in shown)


@cache
def _registry() -> Any:
    """Return pint's units, with the angle as a dimension of its own; reading them takes half a second."""
    import pint

    registry: pint.UnitRegistry[float] = pint.UnitRegistry()
    registry.define("radian = [angle] = rad")
    registry.define("steradian = 1 = sr")  # of a lumen
    registry._build_cache()  # it holds what was a number before
    return registry


@cache
def _parsed(unit: str) -> Any:
    """Return pint's unit of a text, None where it is none."""
    text = re.sub(r"\b([mkM]?N)(c?m)\b", r"\1*\2", ALIASES.get(unit, unit).translate(SIGNS).strip())
    text = re.sub(r"\bk?rpm\b", lambda one: "(kturn/minute)" if one[0] == "krpm" else "(turn/minute)", text)
    text = re.sub(r"\brev(?:s|olutions?)?\b", "turn", text)
    text = re.sub(r"(?<=[A-Za-z])(\d)", r"^\1", re.sub(r"(?<=[A-Za-z\d])[ ·](?=[A-Za-z])", "*", text))
    if not text or len(text) > LONGEST_UNIT or not UNIT_TEXT.fullmatch(text) or POWER_OF_POWER.search(text):
        return None
    try:
        found = _registry().parse_units("percent" if text == "%" else text)
    except Exception:  # pint raises many kinds for a text that is no unit
        return None
    return None if found.dimensionless and found == _registry().dimensionless and text != "1" else found


def _converted(unit: str, shown: str) -> Conversion | str:
    """Return the conversion between two units; where there is none what the first is instead, empty where it is no unit."""
    given, wanted = _parsed(unit), _parsed(shown)
    if given is None or wanted is None:
        return ""
    if given.dimensionality != wanted.dimensionality:
        return f"is a unit of {_quantity(unit)}"
    make = _registry().Quantity
    none, one, two = (float(make(number, given).to(wanted).magnitude) for number in (0.0, 1.0, 2.0))
    factor = one - none
    if not math.isclose(two - one, factor, rel_tol=1e-9):
        return "is not proportional to it"
    if none and abs(none) > 1e-12 * abs(factor):
        # differences of large numbers cost digits
        return Conversion(factor := float(make(1.0, given).to(wanted).magnitude) - none, none / factor)
    return Conversion(one)


def _quantity(unit: str) -> str:
    """Return what a unit measures, in words, else its dimensions."""
    found = _parsed(unit)
    if found is None:
        return unit
    names = {_parsed(one).dimensionality: words for one, words in QUANTITIES.items()}
    return names.get(found.dimensionality) or str(found.dimensionality)
