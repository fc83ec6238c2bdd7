"""Chirp, multisine and PRBS: the spectra that were ordered, within the amplitude that was ordered."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hjcamp.errors import UsageError
from hjcamp.trajectories import build_trajectory
from hjcamp.trajectories.multisine import Multisine
from hjcamp.trajectories.prbs import TAPS, Prbs

CHIRP = {"kind": "chirp", "amplitude_deg": 10.0, "first_hz": 0.2, "last_hz": 5.0, "duration": 30.0}
MULTISINE = {"kind": "multisine", "amplitude_deg": 20.0, "first_hz": 0.1, "last_hz": 2.0, "lines": 10, "duration": 10.0}
PRBS = {"kind": "prbs", "amplitude_deg": -20.0, "bit_time": 0.5, "rise_time": 0.2, "register": 5, "duration": 15.5}


def power(config: dict[str, Any], rate: float = 200.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the frequencies, Hz, with the power of the angle at them, and the angle, deg."""
    trajectory = build_trajectory(config)
    time = np.arange(round(trajectory.duration * rate)) / rate
    angle = np.degrees(trajectory.reference(time)[0])
    return np.fft.rfftfreq(len(time), 1.0 / rate), np.abs(np.fft.rfft(angle - angle.mean())) ** 2, angle


def test_a_chirp_has_its_power_between_its_ends_and_evenly_over_octaves() -> None:
    frequency, found, angle = power(CHIRP)
    inside = (frequency >= 0.15) & (frequency <= 6.0)
    assert found[inside].sum() > 0.98 * found.sum() and np.abs(angle).max() <= 10.0 + 1e-9
    octaves = [found[(frequency >= low) & (frequency < 2 * low)].sum() for low in (0.4, 0.8, 1.6)]
    assert max(octaves) < 1.3 * min(octaves)


def test_a_multisine_has_its_lines_alone_and_low_peaks() -> None:
    frequency, found, angle = power(MULTISINE)
    lines = np.rint(np.linspace(1, 20, 10)) * 0.1
    at = np.array([np.argmin(np.abs(frequency - line)) for line in lines])
    assert found[at].sum() > 0.999999 * found.sum() and np.ptp(found[at]) < 1e-6 * found[at].max()
    assert np.abs(angle).max() == pytest.approx(20.0, rel=3e-3) and abs(angle[0]) < 1e-12
    trajectory = build_trajectory(MULTISINE)
    assert isinstance(trajectory, Multisine) and trajectory.crest_factor < 1.9


@pytest.mark.parametrize("register", TAPS)
def test_a_shift_register_has_its_longest_period(register: int) -> None:
    trajectory = build_trajectory(PRBS | {"register": register})
    assert isinstance(trajectory, Prbs)
    bits = trajectory.bits
    assert len(bits) == 2**register - 1 and bits.sum() in (2 ** (register - 1), 2 ** (register - 1) - 1) and bits[0] == 0.0
    # the circular correlation of a longest sequence is flat but for shift 0
    spectrum = np.abs(np.fft.fft(2.0 * bits - 1.0)[1:])
    np.testing.assert_allclose(spectrum, math.sqrt(2.0**register), rtol=1e-9)


@settings(max_examples=40, deadline=None)
@given(
    kind=st.sampled_from((CHIRP, MULTISINE, PRBS)),
    amplitude=st.floats(0.5, 90.0),
    sign=st.sampled_from((1.0, -1.0)),
)
def test_no_signal_leaves_its_amplitude_and_its_rates_are_its_own(kind: dict[str, Any], amplitude: float, sign: float) -> None:
    trajectory = build_trajectory(kind | {"amplitude_deg": sign * amplitude})
    time = np.linspace(0.0, trajectory.duration, 4001)
    angle, velocity, acceleration = trajectory.reference(time)
    assert np.degrees(np.abs(angle)).max() <= amplitude * (1.0 + 1e-9) and angle[0] == 0.0
    assert np.isfinite(velocity).all() and np.isfinite(acceleration).all()
    middle = time[1:-1]
    step = 1e-6
    slope = (trajectory.reference(middle + step)[0] - trajectory.reference(middle - step)[0]) / (2.0 * step)
    np.testing.assert_allclose(velocity[1:-1], slope, atol=1e-4 * np.abs(velocity).max())


@pytest.mark.parametrize(
    ("config", "said"),
    [
        (CHIRP | {"last_hz": 0.2}, "kind sine is a sine of one frequency"),
        (CHIRP | {"last_hz": 900.0}, "last_hz is 900.0; a number from"),
        (MULTISINE | {"lines": 1}, "a whole number from 2 to 200"),
        (MULTISINE | {"lines": 2.5}, "a whole number from 2 to 200"),
        (MULTISINE | {"lines": 50}, "there are 20 multiples of the first"),
        (MULTISINE | {"first_hz": 3.0}, "there are 0 multiples of the first"),
        (PRBS | {"register": 2}, "a whole number from 3 to 12"),
        (PRBS | {"rise_time": 0.6}, "longer than trajectory.bit_time"),
        (PRBS | {"bit": 1.0}, "did you mean 'bit_time'"),
    ],
)
def test_what_does_not_fit_together_is_refused(config: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        build_trajectory(config)
