"""Noise by the readings alone: counters, analog sensors, both, and motion of a few samples a period."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import COUNT, measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated, free_base
from hjcamp.diagnosis.data.sensor_noise import noise_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.records.noise import step_of

TIME = np.linspace(0.0, 10.0, 5000)
DRAWN = np.random.default_rng(1).normal(0.0, 1.0, 12000)


def test_a_counter_and_an_analog_sensor() -> None:
    counted = np.round(np.sin(TIME) / 0.01) * 0.01
    assert step_of(counted) == pytest.approx(0.01)
    assert noise_of(counted) == pytest.approx(0.01 / np.sqrt(12.0), rel=1e-6)
    assert noise_of(np.sin(TIME) + 0.02 * DRAWN[:5000]) == pytest.approx(0.02, rel=0.1)
    assert noise_of(np.sin(TIME)) < 1e-5


def test_a_long_analog_log_is_no_counter() -> None:
    # two of twelve thousand readings come as close to each other as you like: that is no step
    assert step_of(DRAWN) == 0.0
    assert noise_of(np.sin(np.linspace(0.0, 20.0, 12000)) + 0.02 * DRAWN) == pytest.approx(0.02, rel=0.1)


def test_a_counter_that_shows_few_values() -> None:
    counted = 0.727 * np.random.default_rng(2).integers(0, 6, 300)
    assert step_of(counted) == pytest.approx(0.727)
    # by hand: four gaps between five values are whole by chance in one case of twenty-five
    drawn = np.random.default_rng(3)
    found = [step_of(np.repeat(drawn.uniform(size=5), 40)) > 0.0 for _ in range(400)]
    assert np.mean(found) < 0.05


@pytest.mark.parametrize("decimals", [4, 6])
def test_a_counter_whose_readings_were_printed_with_few_digits(decimals: int) -> None:
    step = 0.0314159
    printed = np.round(np.round(np.sin(TIME) / step) * step, decimals)
    assert step_of(printed) == pytest.approx(step, rel=3e-3)


def test_a_converter_whose_steps_are_finer_than_its_noise() -> None:
    read = np.round((np.sin(TIME) + 0.02 * DRAWN[:5000]) * 100.0) / 100.0
    assert noise_of(read) == pytest.approx(np.hypot(0.02, 0.01 / np.sqrt(12.0)), rel=0.1)


def test_motion_of_nine_samples_a_period_is_no_noise() -> None:
    at = np.arange(6000)
    phases = np.random.default_rng(2).uniform(0.0, 2.0 * np.pi, 40)
    fast = np.sum(np.sin(np.linspace(0.02, 0.3, 40)[:, None] * 2.0 * np.pi * at + phases[:, None]), axis=0)
    assert noise_of(fast + 0.01 * DRAWN[:6000]) == pytest.approx(0.01, rel=0.3)


def test_a_counter_begins_to_count_within_a_step(axis: Path) -> None:
    measured = measured_tests([measured_log()])
    assert measured.steps == pytest.approx([COUNT])
    free = {one.name: one for one in calibrated(measured, {}, unknowns=False).base.fitted.free}
    zero = free["zero.position_m"]
    assert (zero.low, zero.high) == (pytest.approx(-COUNT), pytest.approx(COUNT))


@pytest.mark.parametrize(("noise", "known"), [(0.3, True), (0.9, True), (1.5, False), (20.0, False)])
def test_a_converter_finer_than_its_noise_begins_nowhere(axis: Path, noise: float, known: bool) -> None:
    measured = measured_tests([measured_log()])
    vars(measured).update(noise=noise * measured.steps)
    assert ("zero.position_m" in free_base(measured, {})[0]) == known


def test_a_declared_step_is_taken_as_it_is() -> None:
    read = np.round(np.sin(TIME) / 0.01) * 0.01
    assert noise_of(read, 0.04) == pytest.approx(0.04 / np.sqrt(12.0), rel=1e-6)


@pytest.mark.parametrize("noise", [0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 2.0])
def test_the_noise_of_a_counter_is_known_between_whole_steps(noise: float) -> None:
    # differences of counts are whole steps: their plain median is 24 % too small at 0.3 steps and 15 % too large at 0.5
    generator, time = np.random.default_rng(0), np.arange(4000.0)
    course = 30.0 * np.sin(time / 200.0) + 20.0 * np.sin(time / 57.0)
    found = [0.1 * np.round(course + noise * generator.standard_normal(4000) + generator.uniform()) for _ in range(10)]
    assert np.mean([noise_of(one) for one in found]) == pytest.approx(0.1 * np.hypot(noise, 12.0**-0.5), rel=0.05)
