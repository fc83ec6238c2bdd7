"""Any unit that pint knows, in maps and at the ends of fields' names."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.errors import UsageError
from hjcamp.model.declare.field import Field
from hjcamp.model.language.field_unit import field_of, unit_of_field, unit_shown
from hjcamp.records.units import Conversion, conversion_to_field, is_unit

#: A unit, that of the field, and what 2 of the first are in the second, by the unit's definition.
TABLE = [
    ("ft", "m", 0.6096), ("in", "mm", 50.8), ("yd", "m", 1.8288), ("nmi", "m", 3704.0),
    ("mph", "m/s", 0.89408), ("ft/s", "m/s", 0.6096), ("knot", "km/h", 3.704), ("in/min", "mm/s", 50.8 / 60),
    ("lb", "kg", 0.90718474), ("oz", "g", 56.69904625), ("slug", "kg", 29.18780587), ("tonne", "kg", 2000.0),
    ("gal/min", "L/min", 7.570823568), ("ft^3/min", "m^3/s", 2 * 0.3048**3 / 60), ("mL/h", "L/h", 0.002),
    ("hp", "W", 1491.3997431651), ("BTU/h", "W", 0.58614222), ("kW", "W", 2000.0), ("hp", "kW", 1.4913997431651),
    ("torr", "Pa", 2 * 101325 / 760), ("atm", "bar", 2.0265), ("inHg", "Pa", 6772.777), ("psi", "kPa", 13.789514586336726),
    ("lbf", "N", 8.896443230521), ("ft*lbf", "N m", 2.7116358966628), ("ozf*in", "mN m", 14.123103), ("N cm", "N m", 0.02),
    ("mT", "T", 0.002), ("kHz", "Hz", 2000.0), ("1/min", "Hz", 2 / 60), ("uH", "H", 2e-6), ("nF", "F", 2e-9),
    ("N/mm", "N/m", 2000.0), ("lbf/in", "N/m", 350.253671), ("lux", "lx", 2.0), ("klx", "lx", 2000.0),
    ("°F", "K", 461.67 / 1.8),
    ("degC", "K", 275.15), ("delta_degC", "K", 2.0), ("degC/min", "K/s", 2 / 60),

    ("mrad", "deg", 0.36 / np.pi), ("rev/min", "rpm", 2.0), ("Nm/deg", "N m/rad", 360 / np.pi),
    ("µm", "m", 2e-6), ("krpm", "rpm", 2000.0),
]  # fmt: skip
REFUSED = [
    ("kg", "m", "'kg' is a unit of a mass, and 'x' is a length"),
    ("Hz", "rad/s", "'x' is a speed of turning"),
    ("rad", "1", "'rad' is a unit of an angle, and 'x' is a number"),
    ("dB", "1", "'dB' is not proportional to it"),
    ("N", "N/m", "'N' is a unit of a force"),
    ("degC/s", "K", "is a unit of"),
    ("metre/sec", "m", "is a unit of a speed"),
    ("xyz", "m", "Allowed: .*mm"),
    ("9^9^9^9", "m", "unknown unit"),
    ("2**99999", "m", "unknown unit"),
    ("1e99999*m", "m", "unknown unit"),
    ("__import__('os')", "m", "unknown unit"),
    ("m" * 500, "m", "unknown unit"),
]


@pytest.mark.parametrize(("unit", "shown", "expected"), TABLE)
def test_a_unit_is_converted_exactly(unit: str, shown: str, expected: float) -> None:
    found = conversion_to_field(Field("x", shown, True, ""), unit, "here")
    assert (2.0 + found.shift) * found.factor == pytest.approx(expected, rel=1e-7) and is_unit(unit)


@pytest.mark.parametrize(("unit", "shown", "said"), REFUSED)
def test_another_dimension_is_refused_with_what_was_expected(unit: str, shown: str, said: str) -> None:
    with pytest.raises(UsageError, match=said) as refusal:
        conversion_to_field(Field("x", shown, True, ""), unit, "here")
    assert "\n" not in str(refusal.value)


def test_a_difference_of_temperatures_is_not_shifted() -> None:
    field = Field("x", "K", True, "")
    assert conversion_to_field(field, "delta_degF", "here") == Conversion(pytest.approx(5 / 9))
    assert conversion_to_field(field, "degF", "here").shift == 459.67


@pytest.mark.parametrize(
    ("si", "field"),
    [
        ("T", "x_tesla"), ("Hz", "x_hertz"), ("H", "x_henry"), ("F", "x_farad"), ("N/m", "x_n_per_m"), ("lx", "x_lx"),
        ("K/s", "x_k_per_s"), ("N*m/rad", "x_nm_per_rad"), ("V/s", "x_v_per_s"), ("m/s", "x_m_per_s"), ("Pa/m", "x_pa_per_m"),
    ],
)  # fmt: skip
def test_an_input_in_any_si_unit_has_a_field(si: str, field: str) -> None:
    assert field_of("x", si, "here") == field
    unit = unit_of_field(field, "here")
    assert unit.si == si and unit.scale == 1.0 and unit_shown(unit.shown).si == si
    assert field_of(field, si, "here") == field


@pytest.mark.parametrize(
    ("name", "shown", "scale"),
    [("force_n_per_mm", "N/mm", 1e-3), ("x_kn_per_m2", "kN/m^2", 1e-3), ("a_w_per_cm2", "W/cm^2", 1e-4)],
)
def test_quotients_carry_their_scale(name: str, shown: str, scale: float) -> None:
    unit = unit_of_field(name, "here")
    assert unit.shown == shown and unit.scale == pytest.approx(scale)
