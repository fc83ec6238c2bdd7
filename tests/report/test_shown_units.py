"""Numbers for people: every conversion against pint, every unit of the library readable."""

from __future__ import annotations

import pint
import pytest

from hjcamp.effects import load_effects
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.report.units import SHOWN, label, plain, shown, told, told_interval


def test_every_factor_agrees_with_pint() -> None:
    registry = pint.UnitRegistry()
    for unit, (name, factor) in SHOWN.items():
        readable = name.replace("mm2", "mm**2").replace("mm3", "mm**3").replace("s2", "s**2").replace(" ", "*")
        if unit != "1":
            assert (1.0 * registry(unit)).to(readable).magnitude == pytest.approx(factor), unit


def test_defaults_of_the_library_read_without_exponent() -> None:
    parameters = [one for effect in load_effects([]).values() for one in effect.parameters.values()]
    parameters += [PumpJoint.parameters[name] for name in PumpJoint.base_parameters]
    for parameter in parameters:
        assert "e" not in plain(shown(parameter.default, parameter.unit)[0]), parameter


def test_what_is_told() -> None:
    assert told(2.79e-16, "m^3/(s*Pa)") == "0.279 mm3/(s MPa)"
    assert told(2.57e13, "Pa/m^3") == "0.0257 MPa/mm3"
    assert told(0.123456, "1") == "0.123"
    assert told(12345.6, "N") == "12346 N"
    assert told(0.0, "N") == "0 N"
    assert told(7.20, "N") == "7.2 N"
    assert told_interval({"unit": "Pa", "ci95": [4.92e5, 5.01e5]}) == "0.492 to 0.501"
    assert told(465.0, "Pa") == "465 Pa" and told(4650.0, "Pa") == "0.00465 MPa"
    assert told(0.0065, "m^3") == "0.0065 m^3" and told(8.5e-9, "m^3") == "8.5 mm3"
    assert told(31.0, "m/s") == "31 m/s" and told(0.31, "m/s") == "310 mm/s"
    assert told(0.3, "N*s/m") == "0.3 N*s/m" and told(120.0, "N*s/m") == "0.12 N s/mm" and told(1.08, "N/m") == "1.08 N/m"
    # both ends in the unit of the value
    assert told_interval({"unit": "Pa", "value": 1500.0, "ci95": [900.0, 2100.0]}) == "0.0009 to 0.0021"
    assert told_interval({"unit": "kg", "value": 1.1, "ci95": [0.9, 1.3]}) == "0.9 to 1.3"
    assert told_interval({"unit": "N", "ci95": [2.94512, 2.94533]}) == "2.9451 to 2.9453"


def test_labels() -> None:
    assert label("coulomb_positive") == "Coulomb friction, positive"
    assert label("arm_deg") == "arm angle"
    assert label("conductance_above") == "conductance above"
