"""Units at the end of a log's field names, such as ``position_m`` and ``level_v``, and their SI units."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass

from hjcamp.errors import UsageError, unknown


@dataclass(frozen=True)
class FieldUnit:
    """A unit of a field: how people write it, its SI unit, and ``scale``, its number for one SI unit."""

    suffix: str
    shown: str
    si: str
    scale: float


FIELD_UNITS: dict[str, FieldUnit] = {
    unit.suffix: unit
    for unit in (
        FieldUnit("s", "s", "s", 1.0),
        FieldUnit("ms", "ms", "s", 1e3),
        FieldUnit("deg", "deg", "rad", 180.0 / math.pi),
        FieldUnit("rad", "rad", "rad", 1.0),
        FieldUnit("turn", "turn", "rad", 0.5 / math.pi),
        FieldUnit("per_s", "1/s", "1/s", 1.0),
        FieldUnit("rad_per_s", "rad/s", "rad/s", 1.0),
        FieldUnit("deg_per_s", "deg/s", "rad/s", 180.0 / math.pi),
        FieldUnit("rpm", "rpm", "rad/s", 30.0 / math.pi),
        FieldUnit("rad_per_s2", "rad/s^2", "rad/s^2", 1.0),
        FieldUnit("m", "m", "m", 1.0),
        FieldUnit("mm", "mm", "m", 1e3),
        FieldUnit("um", "um", "m", 1e6),
        FieldUnit("cm", "cm", "m", 1e2),
        FieldUnit("m_per_s", "m/s", "m/s", 1.0),
        FieldUnit("mm_per_s", "mm/s", "m/s", 1e3),
        FieldUnit("km_per_h", "km/h", "m/s", 3.6),
        FieldUnit("m_per_s2", "m/s^2", "m/s^2", 1.0),
        FieldUnit("n", "N", "N", 1.0),
        FieldUnit("kn", "kN", "N", 1e-3),
        FieldUnit("nm", "N m", "N*m", 1.0),
        FieldUnit("mnm", "mN m", "N*m", 1e3),
        FieldUnit("pa", "Pa", "Pa", 1.0),
        FieldUnit("kpa", "kPa", "Pa", 1e-3),
        FieldUnit("mpa", "MPa", "Pa", 1e-6),
        FieldUnit("bar", "bar", "Pa", 1e-5),
        FieldUnit("mbar", "mbar", "Pa", 1e-2),
        FieldUnit("kg", "kg", "kg", 1.0),
        FieldUnit("g", "g", "kg", 1e3),
        FieldUnit("kg_per_s", "kg/s", "kg/s", 1.0),
        FieldUnit("g_per_s", "g/s", "kg/s", 1e3),
        FieldUnit("kg_per_m3", "kg/m^3", "kg/m^3", 1.0),
        FieldUnit("g_per_l", "g/L", "kg/m^3", 1.0),
        FieldUnit("mol_per_m3", "mol/m^3", "mol/m^3", 1.0),
        FieldUnit("mol_per_l", "mol/L", "mol/m^3", 1e-3),
        FieldUnit("mol", "mol", "mol", 1.0),
        FieldUnit("mol_per_s", "mol/s", "mol/s", 1.0),
        FieldUnit("m3", "m^3", "m^3", 1.0),
        FieldUnit("l", "L", "m^3", 1e3),
        FieldUnit("m3_per_s", "m^3/s", "m^3/s", 1.0),
        FieldUnit("m3_per_h", "m^3/h", "m^3/s", 3.6e3),
        FieldUnit("l_per_s", "L/s", "m^3/s", 1e3),
        FieldUnit("l_per_h", "L/h", "m^3/s", 3.6e6),
        FieldUnit("ml_per_min", "mL/min", "m^3/s", 6e7),
        FieldUnit("l_per_min", "L/min", "m^3/s", 6e4),
        FieldUnit("v", "V", "V", 1.0),
        FieldUnit("mv", "mV", "V", 1e3),
        FieldUnit("a", "A", "A", 1.0),
        FieldUnit("ma", "mA", "A", 1e3),
        FieldUnit("w", "W", "W", 1.0),
        FieldUnit("kw", "kW", "W", 1e-3),
        FieldUnit("w_per_m2", "W/m^2", "W/m^2", 1.0),
        FieldUnit("ohm", "ohm", "ohm", 1.0),
        FieldUnit("j", "J", "J", 1.0),
        FieldUnit("m2", "m^2", "m^2", 1.0),
        FieldUnit("hertz", "Hz", "Hz", 1.0),
        FieldUnit("khertz", "kHz", "Hz", 1e-3),
        FieldUnit("tesla", "T", "T", 1.0),
        FieldUnit("mtesla", "mT", "T", 1e3),
        FieldUnit("weber", "Wb", "Wb", 1.0),
        FieldUnit("henry", "H", "H", 1.0),
        FieldUnit("mhenry", "mH", "H", 1e3),
        FieldUnit("farad", "F", "F", 1.0),
        FieldUnit("ufarad", "uF", "F", 1e6),
        FieldUnit("coulomb", "C", "C", 1.0),
        FieldUnit("siemens", "S", "S", 1.0),
        FieldUnit("lx", "lx", "lx", 1.0),
        FieldUnit("lm", "lm", "lm", 1.0),
        FieldUnit("k", "K", "K", 1.0),
        FieldUnit("percent", "%", "1", 100.0),
        FieldUnit("ratio", "1", "1", 1.0),
    )
}

# Ends of names by which people mean a unit that is written otherwise here.
MEANT = {
    "mps": "m_per_s", "ms2": "m_per_s2", "mps2": "m_per_s2", "mmps": "mm_per_s", "kph": "km_per_h", "kmh": "km_per_h",
    "kmph": "km_per_h",
    "dps": "deg_per_s", "degps": "deg_per_s", "radps": "rad_per_s", "rads": "rad_per_s",
    "lpm": "l_per_min", "lps": "l_per_s", "lph": "l_per_h", "hz": "per_s", "sec": "s", "secs": "s", "seconds": "s",
    "msec": "ms", "degree": "deg", "degrees": "deg", "radian": "rad", "radians": "rad", "rev": "turn", "revs": "turn", "turns": "turn",
    "meter": "m", "meters": "m", "metre": "m", "metres": "m", "volt": "v", "volts": "v", "amp": "a", "amps": "a", "newton": "n",
    "newtons": "n", "watt": "w", "watts": "w", "pascal": "pa", "liter": "l", "litre": "l", "liters": "l", "litres": "l",
    "pct": "percent",
    "perc": "percent", "kelvin": "k", "gpl": "g_per_l", "kgps": "kg_per_s", "joule": "j", "joules": "j",
}  # fmt: skip
# Ends of names that people give to temperatures.
CELSIUS = ("c", "degc", "celsius")

# What stands in a quotient below: n_per_mm, k_per_s.
PER, POWERS = "_per_", "23"


def _quotient(suffix: str) -> FieldUnit | None:
    """Return the unit of a suffix such as ``n_per_m`` or ``w_per_m2``, made of two units of the table; None for another one."""
    above, per, below = suffix.partition(PER)
    power = below[-1:] if below[-1:] in POWERS and below not in FIELD_UNITS else ""
    first, second = FIELD_UNITS.get(above), FIELD_UNITS.get(below.removesuffix(power) if power else below)
    if not per or first is None or second is None or any(part in unit.shown for unit in (first, second) for part in "/%"):
        return None
    shown, si = (
        f"{one}/({other})" if "*" in other or " " in other else f"{one}/{other}{'^' + power if power else ''}"
        for one, other in ((first.shown, second.shown), (first.si, second.si))
    )
    return FieldUnit(suffix, shown, si, first.scale / second.scale ** int(power or 1))


def unit_shown(shown: str) -> FieldUnit:
    """Return the unit that is written so, of the table or a quotient of two; raises UsageError where there is none."""
    for unit in FIELD_UNITS.values():
        if unit.shown == shown:
            return unit
    above, _, below = shown.partition("/")
    base, _, power = below.strip("()").partition("^")
    suffixes = {unit.shown: unit.suffix for unit in reversed(FIELD_UNITS.values())}
    found = _quotient(f"{suffixes.get(above, '')}{PER}{suffixes.get(base, '')}{power}")
    if found is None:
        raise unknown("unit", shown, [unit.shown for unit in FIELD_UNITS.values()])
    return found


def unit_of_field(name: str, where: str, si: str = "") -> FieldUnit:
    """Return the unit that a field's name ends with; the longest that fits.

    Raises ``UsageError`` where there is none; it offers units of the SI unit ``si`` alone, where that is known.
    """
    parts = name.split("_")
    for first in range(1, len(parts)):
        suffix = "_".join(parts[first:])
        if (found := FIELD_UNITS.get(suffix) or _quotient(suffix)) is not None:
            return found
    # as people write m/s without its stroke
    for first in range(1, len(parts)):
        suffix = "_".join([*parts[first:-1], "per", parts[-1]])
        if suffix in FIELD_UNITS:
            meant = "_".join([*parts[:first], suffix])
            raise UsageError(f"{where}: '{name}' ends with no unit; did you mean '{meant}', in {FIELD_UNITS[suffix].shown}?")
    if len(parts) > 1 and parts[-1] in CELSIUS:
        meant = "_".join([*parts[:-1], "k"])
        raise UsageError(f"{where}: '{name}': a log holds kelvins; write '{meant}', and 'unit: degC' in the map of an import")
    if len(parts) > 1 and (unit := FIELD_UNITS.get(MEANT.get(parts[-1].casefold(), ""))):
        meant = "_".join([*parts[:-1], unit.suffix])
        raise UsageError(f"{where}: '{name}' ends with no unit; did you mean '{meant}', in {unit.shown}?")
    ends = FIELD_UNITS if not si else [suffix for suffix, unit in FIELD_UNITS.items() if unit.si == si] or FIELD_UNITS
    before = "_".join(parts[:-1] or parts)
    raise unknown("unit at the end of the field", name, [f"{before}_{suffix}" for suffix in ends], where)


def field_of(name: str, si: str, where: str) -> str:
    """Return the field of an input ``name`` in the SI unit ``si``: the name itself where it ends with a unit of that kind."""
    parts = name.split("_")
    for first in range(1, len(parts)):
        suffix = "_".join(parts[first:])
        found = FIELD_UNITS.get(suffix) or _quotient(suffix)
        if found is not None and found.si == si:
            return name
    for unit in FIELD_UNITS.values():
        if unit.si == si and unit.scale == 1.0:
            return f"{name}_{unit.suffix}"
    with suppress(UsageError):
        of_si = {unit.si: unit.shown for unit in FIELD_UNITS.values() if unit.scale == 1.0}
        above, _, below = si.partition("/")
        return f"{name}_{unit_shown(f'{of_si.get(above, above)}/{of_si.get(below, below)}').suffix}"
    raise UsageError(
        f"{where}: no field can hold the unit {si} of '{name}'; give field='{name}_UNIT' with one of " + ", ".join(FIELD_UNITS)
    )
