"""The sliders' motion from the counted arm angle."""

from __future__ import annotations

import numpy as np
from scipy.signal import savgol_coeffs

from hjcamp.discrepancy.evidence import _parabola_kernels, slider_motion


def test_the_kernels_are_those_of_savitzky_and_golay() -> None:
    for order, kernel in enumerate(_parabola_kernels()):
        expected = savgol_coeffs(41, 2, deriv=order, delta=1e-3)
        np.testing.assert_allclose(kernel, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


def test_a_parabola_keeps_its_velocity_and_acceleration() -> None:
    time = np.arange(400) * 1e-3
    arm = 0.3 + 2.0 * time + 5.0 * time**2
    travel, velocity, acceleration = slider_motion(arm, 3.41e-3)
    inner = slice(30, -30)
    np.testing.assert_allclose(travel[inner], 3.41e-3 * arm[inner], rtol=1e-10)
    np.testing.assert_allclose(velocity[inner], 3.41e-3 * (2.0 + 10.0 * time[inner]), rtol=1e-9)
    np.testing.assert_allclose(acceleration[inner], 3.41e-3 * 10.0, rtol=1e-7)


def test_the_velocity_is_zero_where_the_count_rests() -> None:
    arm = np.concatenate([np.zeros(200), np.linspace(0.0, 0.5, 200), np.full(200, 0.5)])
    _, velocity, _ = slider_motion(arm, 3.41e-3)
    assert not velocity[:170].any()
    assert not velocity[-170:].any()
    assert velocity[300] > 0.0
