"""The published transfer functions come back from their own step responses; unusable steps are refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from identification_logs import make, step_log

from hjcamp.configuration.setups import configuration_for
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.constants import constants_of
from hjcamp.plants.pump_joint.calibrate.pump import chosen_order, final_prediction_error, identify_pump
from hjcamp.plants.pump_joint.calibrate.step_response import TransferFunction, rise_time

# Thesis 4.3.2 to 4.3.4 with their printed rise times, which follow from them to within one sample: 86.1, 32.8, 18.0 ms.
PUBLISHED = {
    "pump1_low_gain": (86.1, 66.3, 2279.2, 31000.0, 5, 87.0, 86.1),
    "pump2_low_gain": (1357.1, 160.0, 13956.0, 488560.0, 5, 32.0, 32.8),
    "pump2_high_gain": (6125.0, 245.0, 35700.0, 2205000.0, 2, 17.0, 18.0),
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_transfer_functions_come_back(name: str) -> None:
    *function, delay, printed, exact = PUBLISHED[name]
    logs = [step_log(*function, delay=delay, seed=seed) for seed in range(3)]
    found = identify_pump(logs, constants_of(logs[0], configuration_for))
    assert found.facts["order chosen"] == "3"
    rise = found["rise_time"].value * 1e3
    assert rise == pytest.approx(printed, abs=1.05) and rise == pytest.approx(exact, abs=0.15)
    assert found["pump_delay"].value * 1e3 == pytest.approx(delay, abs=0.1)
    for key, value in zip(("pump_a2", "pump_a1", "pump_a0"), function[1:], strict=True):
        assert found[key].value == pytest.approx(value, rel=0.01)
    assert found["pump_gain"].value == pytest.approx(function[0] * 1e-3 * 180 / math.pi, rel=0.01)
    assert {chart.figure for chart in found.charts} == {"4.3.2", "4.3.3 to 4.3.5"}
    assert not found.warnings


def test_step_response_is_that_of_scipy() -> None:
    from scipy.signal import lti, step

    function = TransferFunction(1.02, 0.0023, ((145.0, 0.48),), 105.0)
    time = np.arange(200) * 1e-3
    exact = step(lti([1.02 * function.denominator[-1]], function.denominator), T=np.arange(0, 0.2, 1e-5))[1]
    expected = np.interp(time - 0.0023, np.arange(0, 0.2, 1e-5), exact, left=0.0)
    np.testing.assert_allclose(function.step(200), expected, atol=2e-6)


def test_rise_time_of_a_single_pole() -> None:
    assert rise_time(TransferFunction(1.0, 0.0, (), 100.0)) == pytest.approx(math.log(9.0) / 100.0, rel=1e-4)


def test_order_is_chosen_where_more_no_longer_pays() -> None:
    assert chosen_order({1: 1.0, 2: 0.1, 3: 0.001, 4: 0.00095, 5: 0.0009, 6: 0.0009}) == 3
    assert chosen_order({1: 1.0, 2: 0.1, 3: 0.09, 4: 0.01}) == 4
    assert final_prediction_error(2.0, 5, 100) == pytest.approx(2.0 * 1.05 / 0.95)


def test_a_step_that_saturates_is_refused() -> None:
    log = step_log()
    columns = dict(log.columns)
    columns["pump_deg"] = np.minimum(columns["time_s"] * 4000.0, 360.0)
    with pytest.raises(UsageError, match=r"saturates.*smaller step"):
        identify_pump([make(columns)], constants_of(log, configuration_for))
    fast = step_log(size=720.0)
    with pytest.raises(UsageError, match="saturates"):
        identify_pump([fast], constants_of(fast, configuration_for))


def test_a_log_without_the_pump_is_refused_and_one_without_a_command_is_not() -> None:
    log = step_log()
    known = constants_of(log, configuration_for)
    without = {name: values for name, values in log.columns.items() if name != "pump_deg"}
    with pytest.raises(UsageError, match="pump_deg"):
        identify_pump([make(without)], known)
    silent = {name: values for name, values in log.columns.items() if name != "command_deg"}
    found = identify_pump([make(silent)], known)
    assert found["pump_delay"].value * 1e3 == pytest.approx(2.0, abs=0.2)
    assert found["pump_delay"].interval is None
    assert any("time 0" in text for text in found.warnings)
