"""The sliders' motion from the counted arm angle."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import convolve1d
from scipy.signal import savgol_coeffs

from hjcamp.plants.pump_joint.diagnosis.measured.signals import _parabola_kernels, slider_motion


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


def test_every_fourth_sample_alone_is_what_it_is_among_all() -> None:
    generator = np.random.default_rng(2)
    arm = np.floor(np.cumsum(generator.standard_normal(1001)) * 3.0) * 1e-3
    for whole, some in zip(slider_motion(arm, 3.41e-3), slider_motion(arm, 3.41e-3, 4), strict=True):
        np.testing.assert_allclose(some, whole[::4], rtol=0.0, atol=1e-12 * np.abs(whole).max())


def test_the_ends_repeat_the_first_and_last_count() -> None:
    arm = np.floor(np.cumsum(np.random.default_rng(3).standard_normal(300)) * 3.0) * 1e-3
    for kernel, found in zip(_parabola_kernels(), slider_motion(arm, 3.41e-3), strict=True):
        expected = convolve1d(arm * 3.41e-3, kernel, mode="nearest")
        moving = found != 0.0
        np.testing.assert_allclose(found[moving], expected[moving], rtol=0.0, atol=1e-12 * np.abs(expected).max())
        assert moving.any()
