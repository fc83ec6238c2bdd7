"""Gain and phase from sines of known systems, the -3 dB of the pumps, and what cannot be seen."""

from __future__ import annotations

import math

import numpy as np
import pytest
import yaml

from hjcamp.configuration.search_path import packaged_root
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.calibrate.frequency_response import Point, bandwidth, bode_charts, ratio_at
from hjcamp.plants.pump_joint.sizing import dynamics

PUMPS = {
    "pump1": ((66.3, 2279.2, 31000.0, 0.005), 4.1),
    "pump2 low": ((160.0, 13956.0, 488560.0, 0.005), 11.0),
    "pump2 high": ((245.0, 35700.0, 2205000.0, 0.002), 20.7),
}


def test_a_delayed_and_weakened_sine_with_drift_is_read_back() -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    given = 20.0 * np.sin(2 * math.pi * 7.0 * time)
    answer = 0.4 * 20.0 * np.sin(2 * math.pi * 7.0 * (time - 0.01)) + 3.0 + 0.5 * time
    found = ratio_at(time, given, answer, 7.0)
    assert abs(found) == pytest.approx(0.4, rel=1e-6)
    assert math.degrees(math.atan2(found.imag, found.real)) == pytest.approx(-360.0 * 7.0 * 0.01, abs=1e-3)


@pytest.mark.parametrize(("given", "printed"), PUMPS.values(), ids=PUMPS)
def test_the_bandwidth_of_a_sweep_is_that_of_the_transfer_function(given: tuple[float, ...], printed: float) -> None:
    campaign = yaml.safe_load((packaged_root() / "campaigns" / "bandwidth.yaml").read_text(encoding="utf-8"))
    frequency = np.array([case["trajectory.frequency_hz"] for case in campaign["vary"]["frequency"].values()])
    ratios = dynamics.response(frequency, *given)
    points = [Point("pump", float(f), complex(r)) for f, r in zip(frequency, ratios, strict=True)]
    found = bandwidth(points)
    assert found is not None and found[0] == pytest.approx(printed, abs=0.06)
    # By hand at the printed frequency: the phase of the denominator and of the delay.
    s = 2j * math.pi * printed
    a2, a1, a0, delay = given
    denominator = ((s + a2) * s + a1) * s + a0
    phase = -math.degrees(math.atan2(denominator.imag, denominator.real)) - 360.0 * printed * delay
    assert found[1] == pytest.approx(phase, abs=4.0)
    said, charts = bode_charts(points)
    assert f"-3 dB at {found[0]:.1f} Hz" in said and [chart.name for chart in charts] == ["gain", "phase"]


def test_a_system_that_follows_has_no_bandwidth() -> None:
    assert bandwidth([Point("x", f, 1.0 + 0j) for f in (1.0, 10.0)]) is None


@pytest.mark.parametrize(("frequency", "seconds", "said"), [(501.0, 2.0, "at most 500 Hz"), (0.5, 4.0, "needs a test of 8 s")])
def test_what_cannot_be_seen_is_refused(frequency: float, seconds: float, said: str) -> None:
    time = np.arange(0.0, seconds, 1e-3)
    with pytest.raises(UsageError, match=said):
        ratio_at(time, np.sin(time), np.sin(time), frequency)
