"""The stability method: its formulas, and what counts as a lasting oscillation."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.plants.pump_joint.studies.critical_gain import lasting_period
from hjcamp.plants.pump_joint.studies.ziegler_nichols import CriticalPoint

TIME = np.arange(2000) * 1e-3


def test_the_gains_follow_from_the_critical_point() -> None:
    assert CriticalPoint(2.0, 0.05).pid_gains() == pytest.approx({"kp": 1.2, "ki": 48.0, "kd": 0.0075})


@pytest.mark.parametrize("period", [0.02, 0.052, 0.2])
def test_a_lasting_oscillation_has_its_period(period: float) -> None:
    assert lasting_period(10 + 3 * np.sin(2 * np.pi * TIME / period), 1.0) == pytest.approx(period, rel=0.01)


def test_one_that_dies_away_is_none() -> None:
    assert lasting_period(10 * np.exp(-3 * TIME) * np.sin(2 * np.pi * TIME / 0.05), 0.01) is None


def test_one_below_the_sensor_is_none() -> None:
    assert lasting_period(0.3 * np.sin(2 * np.pi * TIME / 0.05), 1.0) is None
