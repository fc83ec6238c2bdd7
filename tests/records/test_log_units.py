"""The conversions of log fields."""

from __future__ import annotations

import numpy as np
import pint
import pytest

from hjcamp.errors import UsageError
from hjcamp.records.log import FIELDS
from hjcamp.records.units import TRAVEL, deg_from_rad, factor_to_field, mpa_from_pa, pa_from_mpa, rad_from_deg, units_of


@pytest.mark.parametrize("field", FIELDS, ids=lambda field: field.name)
def test_every_factor_agrees_with_pint(field) -> None:  # type: ignore[no-untyped-def]
    registry = pint.UnitRegistry()
    for unit in set(units_of(field.name)) - set(TRAVEL) - {"1"}:
        expected = registry.Quantity(1.0, unit).to(field.unit).magnitude
        assert factor_to_field(field.name, unit, "here") == pytest.approx(expected, rel=1e-12)


def test_to_si_and_back() -> None:
    values = np.array([-90.0, 0.0, 180.0])
    np.testing.assert_allclose(rad_from_deg(values), np.deg2rad(values))
    np.testing.assert_allclose(deg_from_rad(rad_from_deg(values)), values)
    assert pa_from_mpa(0.26) == pytest.approx(260_000.0) and mpa_from_pa(260_000.0) == pytest.approx(0.26)
    assert factor_to_field("pump_deg", "mm", "here") == 360.0
    with pytest.raises(UsageError, match="unknown field"):
        units_of("arm")
