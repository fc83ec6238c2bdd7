"""Numbers for people: every conversion against pint, every unit of the library readable."""

from __future__ import annotations

import math
import re

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hjcamp.commands.any_plant.remarks.outside_words import by_condition_words
from hjcamp.commands.any_plant.remarks.remaining_words import still_errs
from hjcamp.effects import load_effects
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.report.wording.repeatability import worst_words
from hjcamp.report.wording.units import (
    SHOWN,
    decimals_of,
    label,
    plain,
    rounded,
    shown,
    told,
    told_error,
    told_estimate,
    told_interval,
    told_like,
)


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
    assert told_interval({"unit": "Pa", "ci95": [4.92e5, 5.01e5]}) == "0.4920 to 0.5010"
    assert told(465.0, "Pa") == "465 Pa" and told(4650.0, "Pa") == "0.00465 MPa"
    assert told(0.0065, "m^3") == "0.0065 m^3" and told(8.5e-9, "m^3") == "8.5 mm3"
    assert told(31.0, "m/s") == "31 m/s" and told(0.31, "m/s") == "310 mm/s"
    assert told(0.3, "N*s/m") == "0.3 N*s/m" and told(120.0, "N*s/m") == "0.12 N s/mm" and told(1.08, "N/m") == "1.08 N/m"
    # both ends in the unit of the value
    assert told_interval({"unit": "Pa", "value": 1500.0, "ci95": [900.0, 2100.0]}) == "0.00090 to 0.00210"
    assert told_interval({"unit": "kg", "value": 1.1, "ci95": [0.9, 1.3]}) == "0.90 to 1.30"
    assert told_interval({"unit": "N", "ci95": [2.94512, 2.94533]}) == "2.94512 to 2.94533"


def test_labels() -> None:
    assert label("coulomb_positive") == "Coulomb friction, positive"
    assert label("arm_deg") == "arm angle"
    assert label("conductance_above") == "conductance above"


@given(
    st.floats(-1e9, 1e9).filter(lambda value: abs(value) > 1e-12),
    st.floats(1e-9, 10.0),
    st.floats(1e-9, 10.0),
    st.sampled_from(sorted(SHOWN)),
)
def test_a_value_is_never_shown_outside_its_own_interval(value: float, below: float, above: float, unit: str) -> None:
    low, high = value - below * abs(value), value + above * abs(value)
    row = {"value": value, "unit": unit, "ci95": [low, high]}
    seen = float(told_estimate(row).partition(" ")[0])
    ends = [float(end) for end in told_interval(row).split(" to ")]
    assert ends[0] <= seen <= ends[1]
    # no more is lost than a twentieth of the half width, unless seven digits are too few to show it
    factor = shown(value, unit)[0] / value
    width = max(0.5 * (high - low) * factor * 0.0501, 0.501e-6 * abs(value * factor))
    for text, number in zip((seen, *ends), (value, low, high), strict=True):
        assert abs(text - number * factor) <= width


@given(st.floats(-1e6, 1e6), st.floats(1e-12, 1e6))
def test_an_uncertainty_has_two_digits_and_its_value_as_many_decimals(value: float, error: float) -> None:
    places = decimals_of(error)
    assert places is not None
    text = rounded(error, places)
    assert len(text.partition("e")[0].replace(".", "").strip("0").rjust(2, "0")) <= 2 or error >= 100.0
    assert abs(float(text) - error) <= 0.0501 * error
    assert decimals_of(0.0) is None and decimals_of(math.inf) is None


def test_published_faults_are_shown_right() -> None:
    stiffness = {"value": 140.2, "unit": "N/m", "ci95": [140.1, 140.3]}
    assert (told_estimate(stiffness), told_interval(stiffness)) == ("0.14020 N/mm", "0.14010 to 0.14030")
    assert told_like(0.5, {"value": 20.0, "unit": "N/m", "ci95": [10.0, 30.0]}) == "0.5 N/m"
    assert told_error(80.0, 0.0035, "kg") == "80.0000 ± 0.0035 kg"
    assert told_error(15.0, 0.0023, "N") == "15.0000 ± 0.0023 N"
    assert told_estimate({"value": 1.0, "unit": "N", "ci95": [0.001, 50.0]}) == "1 N"
    assert told_interval({"value": 1.0, "unit": "N", "ci95": [0.001, 50.0]}) == "0.001 to 50"
    assert told_estimate({"value": 2.0, "unit": "N", "ci95": [1.0, 3.0], "told": False}) == "2 N"


@pytest.mark.parametrize("times", [0.5, 1.26, 9.96, 99.6, 104.0, 372.0, 12345.0])
def test_so_many_times_is_a_number_as_people_write_it(times: float) -> None:
    row = {"condition": "a", "channel": "speed_rpm", "over_floor": times, "shared": None}
    [worst] = worst_words([row], "the noise")
    still = still_errs("speed_rpm", {"value": None, "low": 0.1, "high": 0.1 * times, "unit": "rpm"})
    [differs, _] = by_condition_words({"left": 1.0, "parameters": {}}, times)
    for said in (worst, still, differs):
        numbers = [float(one) for one in re.findall(r"(?<![\w.])\d+(?:\.\d+)?(?=[ ,.:])", said)]
        assert "e+" not in said and any(one == pytest.approx(times, rel=0.05) for one in numbers), said
