"""dp/dV and leakage: recovered from logs with noise and counts, with range, threshold and warnings."""

from __future__ import annotations

import numpy as np
import pytest
from identification_logs import compliance_log, leakage_log, make

from hjcamp.configuration.setups import configuration_for
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.compliance import identify_compliance
from hjcamp.plants.pump_joint.calibrate.constants import constants_of
from hjcamp.plants.pump_joint.calibrate.leakage import Leak, identify_leakage


def test_stiffness_with_interval_modulus_and_air() -> None:
    logs = [compliance_log(0.031, seed) for seed in range(4)]
    found = identify_compliance(logs, constants_of(logs[0], configuration_for))
    low, high = found["line_stiffness"].interval or (0.0, 0.0)
    assert low < 3.1e13 < high and high - low < 0.01 * 3.1e13
    # 0.031 MPa/mm3 in 1705 mm3 of tubing; by 4.4.3.11 the tubing alone would be softer.
    assert found["effective_modulus"].value * 1e-6 == pytest.approx(52.9, abs=0.1)
    assert any("stiffer than its tubing" in text for text in found.warnings)


def test_published_stiffness_leaves_little_air() -> None:
    logs = [compliance_log(0.0257, seed) for seed in range(2)]
    found = identify_compliance(logs, constants_of(logs[0], configuration_for))
    assert found.facts["tubing alone by 4.4.3.11"] == "48.9 MPa"
    assert float(found.facts["air content by 4.4.3.14"].split()[0]) == pytest.approx(0.077, abs=0.01)


def test_range_of_validity_leaves_out_what_is_clipped() -> None:
    logs = [compliance_log(0.0257, seed, floor_mpa=0.2) for seed in range(2)]
    found = identify_compliance(logs, constants_of(logs[0], configuration_for))
    assert found["line_stiffness"].value == pytest.approx(2.57e13, rel=0.02)
    assert any("constant within 5 %" in text for text in found.warnings)


def test_one_repetition_has_no_interval() -> None:
    log = compliance_log()
    assert identify_compliance([log], constants_of(log, configuration_for))["line_stiffness"].interval is None


def test_compliance_with_a_free_joint_or_no_pressure_is_refused() -> None:
    log = compliance_log()
    known = constants_of(log, configuration_for)
    with pytest.raises(UsageError, match="blocked joint"):
        identify_compliance([make({**log.columns, "arm_deg": np.linspace(0.0, 5.0, 2000)})], known)
    flat = {**log.columns, "pressure1_mpa": np.full(2000, 0.3), "pressure2_mpa": np.full(2000, 0.3)}
    with pytest.raises(UsageError, match="move the pump further"):
        identify_compliance([make(flat)], known)


def test_leak_is_the_solution_of_its_equation() -> None:
    leak = Leak(0.64, 0.005, 1.0, 0.59)
    time = np.linspace(0.0, 10.0, 100001)
    course = leak.course(time)
    falls = np.array([leak.fall(float(value)) for value in course[::100]])
    np.testing.assert_allclose(-np.gradient(course, time)[::100][1:-1], falls[1:-1], rtol=2e-3)


def test_leakage_rates_and_threshold() -> None:
    logs = [leakage_log(seed=seed) for seed in range(4)]
    found = identify_leakage(logs, 2.57e13, 700.0)
    assert found["leakage.threshold"].value == pytest.approx(0.59e6, rel=2e-3)
    for name, rate in (("leak_rate_620_kpa", 0.0331e6), ("leak_rate_600_kpa", 0.0130e6), ("leak_rate_560_kpa", 2800.0)):
        assert found[name].value == pytest.approx(rate, rel=0.02)
        low, high = found[name].interval or (0.0, 0.0)
        assert low < found[name].value < high
    assert found["leakage.conductance"].value == pytest.approx(0.005 / 2.57e13, rel=0.02)


@pytest.mark.study
def test_leakage_below_the_threshold_names_none() -> None:
    found = identify_leakage([leakage_log(0.5, seed=seed) for seed in range(2)], 2.57e13, 700.0)
    assert "leakage.threshold" not in {one.name for one in found.estimates}
    assert any("no threshold" in text for text in found.warnings)


def test_a_leakage_test_in_which_something_moves_is_refused() -> None:
    log = leakage_log()
    with pytest.raises(UsageError, match="pump_deg moves"):
        identify_leakage([make({**log.columns, "pump_deg": np.linspace(0, 50, 15000)})], 2.57e13, 700.0)
