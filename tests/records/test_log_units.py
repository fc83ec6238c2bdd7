"""The conversions of log fields."""

from __future__ import annotations

import pint
import pytest

from hjcamp.errors import UsageError
from hjcamp.model.declare.field import Field
from hjcamp.model.language.field_table import fields_of
from hjcamp.model.language.field_unit import FIELD_UNITS, MEANT, unit_of_field
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.records.units import conversion_to_field, units_of


@pytest.fixture(scope="module")
def registry() -> pint.UnitRegistry:
    """Every unit that pint knows, read once."""
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


@pytest.mark.parametrize("shown", [unit.shown for unit in FIELD_UNITS.values()])
def test_every_conversion_agrees_with_pint(registry: pint.UnitRegistry, shown: str) -> None:
    def measured(value: float, unit: str) -> pint.Quantity:
        named = {"%": "percent", "1": "dimensionless", "degC": "degC", "degF": "degF", "L": "liter"}.get(unit)
        named = "standard_gravity" if (unit, shown) == ("g", "m/s^2") else named
        return registry.Quantity(value, named or unit.replace("N m", "N*m").replace("mN m", "mN*m"))

    field = Field("x", shown, True, "")
    for unit, conversion in units_of(field).items():
        expected = measured(40.0, unit.replace("N mm", "N*mm")).to(measured(1.0, shown).units).magnitude
        assert (40.0 + conversion.shift) * conversion.factor == pytest.approx(expected, rel=1e-12), unit
        assert conversion_to_field(field, unit, "here") == conversion


@pytest.mark.parametrize(
    ("shown", "written"),
    [
        ("L/min", "L / min"),
        ("N m", "N*m"),
        ("K", "°C"),
        ("m^3", "mm³"),
        ("m", "µm"),
        ("m/s^2", "m/s²"),
        ("%", "percent"),
        ("m^3", "l"),
        ("g/L", "mg/L"),
        ("kg/s", "mg/h"),
        ("mol/L", "mmol/L"),
    ],
)
def test_a_unit_may_be_written_in_more_than_one_way(shown: str, written: str) -> None:
    conversion_to_field(Field("x", shown, True, ""), written, "here")


@pytest.mark.parametrize(
    ("name", "si", "meant"),
    [
        ("speed_mps", "m/s", "speed_m_per_s"), ("wheel_speed_MPS", "", "wheel_speed_m_per_s"), ("speed_kmh", "m/s", "speed_km_per_h"),
        ("rate_dps", "rad/s", "rate_deg_per_s"), ("level_lpm", "m^3/s", "level_l_per_min"), ("acc_mps2", "m/s^2", "acc_m_per_s2"),
        ("angle_degrees", "rad", "angle_deg"), ("drive_volts", "V", "drive_v"), ("duty_pct", "1", "duty_percent"),
    ],
)  # fmt: skip
def test_the_unit_that_people_mean_is_offered(name: str, si: str, meant: str) -> None:
    with pytest.raises(UsageError, match=f"'{name}' ends with no unit; did you mean '{meant}'"):
        unit_of_field(name, "here", si)
    assert not si or unit_of_field(meant, "here").si == si


@pytest.mark.parametrize("unit", MEANT)
def test_what_people_mean_is_a_unit_and_no_unit_of_its_own(unit: str) -> None:
    assert MEANT[unit] in FIELD_UNITS and unit not in FIELD_UNITS


def test_units_of_what_is_measured_alone_are_offered() -> None:
    with pytest.raises(UsageError, match=r"speed_xyz.*Allowed: speed_km_per_h, speed_m_per_s, speed_mm_per_s$"):
        unit_of_field("speed_xyz", "here", "m/s")


def test_a_unit_of_another_quantity_is_refused() -> None:
    table = fields_of(PumpJoint)
    assert conversion_to_field(table.field("pump_deg"), "mm", "here").factor == 360.0
    with pytest.raises(UsageError, match="'mm' is a unit of a length, and 'arm_deg' is an angle"):
        conversion_to_field(table.field("arm_deg"), "mm", "here")
    with pytest.raises(UsageError, match="unknown field"):
        table.field("arm")
