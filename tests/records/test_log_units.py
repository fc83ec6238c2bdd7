"""The conversions of log fields."""

from __future__ import annotations

import numpy as np
import pint
import pytest

from hjcamp.errors import UsageError
from hjcamp.model.field import Field
from hjcamp.model.field_table import fields_of
from hjcamp.model.field_unit import FIELD_UNITS
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.records.units import conversion_to_field, deg_from_rad, mpa_from_pa, pa_from_mpa, rad_from_deg, units_of


@pytest.fixture(scope="module")
def registry() -> pint.UnitRegistry:
    """Every unit that pint knows, read once."""
    return pint.UnitRegistry(autoconvert_offset_to_baseunit=True)


@pytest.mark.parametrize("shown", [unit.shown for unit in FIELD_UNITS.values()])
def test_every_conversion_agrees_with_pint(registry: pint.UnitRegistry, shown: str) -> None:
    def measured(value: float, unit: str) -> pint.Quantity:
        named = {"%": "percent", "1": "dimensionless", "degC": "degC", "degF": "degF", "L": "liter"}.get(unit)
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


def test_to_si_and_back() -> None:
    values = np.array([-90.0, 0.0, 180.0])
    np.testing.assert_allclose(rad_from_deg(values), np.deg2rad(values))
    np.testing.assert_allclose(deg_from_rad(rad_from_deg(values)), values)
    assert pa_from_mpa(0.26) == pytest.approx(260_000.0) and mpa_from_pa(260_000.0) == pytest.approx(0.26)
    table = fields_of(PumpJoint)
    assert conversion_to_field(table.field("pump_deg"), "mm", "here").factor == 360.0
    with pytest.raises(UsageError, match="'mm' is a unit of a length, and 'arm_deg' is an angle"):
        conversion_to_field(table.field("arm_deg"), "mm", "here")
    with pytest.raises(UsageError, match="unknown field"):
        table.field("arm")
