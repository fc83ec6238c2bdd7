"""The pump's own filter is that of scipy.signal."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter

from hjcamp.plants.pump_joint.diagnosis.measured.hardware import _hardware


@pytest.mark.parametrize("names", [(), (("pump", "pump1"), ("amplifier", "low_gain"))])
def test_the_pump_follows_its_command_as_the_filter_says(names: tuple[tuple[str, str], ...]) -> None:
    hardware = _hardware(names)
    values = hardware.values
    command = 0.3 + np.cumsum(np.random.default_rng(1).standard_normal(4000)) * 1e-2
    system = ([values["pump_gain"]], [1.0, *(values[name] for name in ("pump_a2", "pump_a1", "pump_a0"))])
    numerator, denominator, _ = cont2discrete(system, 1e-3, method="zoh")
    time = np.arange(len(command)) * 1e-3
    late = np.interp(time - values["pump_delay"], time, command) - command[0]
    expected = lfilter(numerator.ravel(), denominator, late) / values["pump_lead"] + command[0]
    np.testing.assert_allclose(hardware.pump_motion(command), expected, rtol=0.0, atol=1e-9 * np.ptp(expected))
