"""Figures 5.2.2 to 5.2.6: the control signal of one error under three filters, and all steps in one view."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hjcamp.configuration.composer import Composer
from hjcamp.plants.pump_joint.studies.design_pictures import design_pictures, filtered, roughness
from hjcamp.records.log import TestLog


@pytest.fixture(scope="module")
def config() -> dict[str, Any]:
    lines = ["controller=pid", "trajectory=ramp_neg", "trajectory.amplitude_deg=-80", "controller.derivative_samples=1"]
    return Composer().compose(lines).config


def log_of(error_deg: np.ndarray) -> TestLog:
    """Return a test of a ramp of -80 deg in 1 s whose error is given."""
    time = np.arange(1000) * 1e-3
    reference = -80.0 * time
    columns = {
        "time_s": time, "phase": np.full(1000, 3.0), "reference_deg": reference, "arm_deg": reference - error_deg,
        "pressure1_mpa": np.full(1000, 0.3), "pressure2_mpa": np.full(1000, 0.3), "pid_deg": np.zeros(1000),
    }  # fmt: skip
    return TestLog(columns, {"campaign": "pid_design", "condition": "dither"}, {})


def test_the_three_terms_by_hand(config: dict[str, Any]) -> None:
    """Negative gains 1.4, 90, 0.018 and scale 8.5 on an error of -1 deg that jumps to -2 deg at 0.5 s."""
    error = np.where(np.arange(1000) < 500, -1.0, -2.0)
    found = filtered(log_of(error), config)
    integral = np.cumsum(error) * 1e-3
    for count in (1, 5, 10):
        jump = np.where((np.arange(1000) >= 500) & (np.arange(1000) < 500 + count), -1.0 / (count * 1e-3), 0.0)
        by_hand = 8.5 * (1.4 * error + 90.0 * integral + 0.018 * jump)
        assert found[count] == pytest.approx(by_hand, abs=1e-6)
    # a jump of 1 deg: the derivative's kick is 8.5 * 0.018 / 1 ms = 153 deg without a filter, a tenth over ten samples
    assert roughness(found[1]) > 3.0 * roughness(found[5]) > 3.0 * roughness(found[10])


def test_both_pictures_of_a_run(config: dict[str, Any]) -> None:
    log = log_of(np.linspace(0.0, 3.0, 1000))
    found = design_pictures([log], {log.condition_key: config})
    (steps, _), (filters, said) = found.values()
    assert steps.startswith("<svg") and "dither (5.2.3, 5.2.5)" in steps and "n = 1, adjusted" in steps
    assert filters.startswith("<svg") and "(c) n = 10" in filters and "n = 5: " in said
    assert design_pictures([TestLog(log.columns, {"campaign": "controllers"}, {})], {}) == {}


def test_the_caption_names_the_repetition_that_is_drawn(config: dict[str, Any]) -> None:
    log = log_of(np.linspace(0.0, 3.0, 1000))
    for number, said in (("1", "first repetition of each step"), ("3", "repetition 3 of each step")):
        one = TestLog(log.columns, {**log.metadata, "repetition": number}, {})
        (_, caption), *_ = design_pictures([one], {one.condition_key: config}).values()
        assert caption.startswith(said)
