"""The PID law against a direct transcription of 5.2.1.2, 5.2.3.1 and Table 5.2.1."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from quiet_loop import columns

from hjcamp.plants.pump_joint.controllers.pid import LONGEST_DERIVATIVE, Pid

POSITIVE = (1.05, 70.0, 0.015)
NEGATIVE = (1.4, 90.0, 0.018)


def transcribed(reference: np.ndarray, velocity: np.ndarray, arm: np.ndarray, first: float, n: int = 5) -> np.ndarray:
    """Return the command of each sample, the equations written out once more."""
    period, command = 1e-3, np.zeros(len(reference))
    error = reference - arm
    direction = first
    for j in range(len(reference)):
        direction = np.sign(velocity[j]) or direction
        kp, ki, kd = POSITIVE if direction > 0 else NEGATIVE
        before = error[j - n] if j >= n else error[0]
        command[j] = 8.5 * (kp * error[j] + ki * error[: j + 1].sum() * period + kd * (error[j] - before) / (n * period))
    return command


def commanded(
    reference: np.ndarray, velocity: np.ndarray, arm: np.ndarray, first: float, n: int = 5, bumpless: float = 0.0
) -> np.ndarray:
    """Return the command of each sample as the rig's own call of the law gives it."""
    values = {name: parameter.default for name, parameter in Pid.parameters.items()}
    given = {"first_direction": first, "derivative_samples": float(n), "bumpless": bumpless}
    parameter = SimpleNamespace(**values | given)
    memory = SimpleNamespace(direction=0.0, integral=0.0, errors=[0.0] * LONGEST_DERIVATIVE)
    found = []
    for index in range(len(reference)):
        sample = SimpleNamespace(
            reference=reference[index],
            velocity=velocity[index],
            arm=arm[index],
            feedforward=0.0,
            period=1e-3,
            index=index,
        )
        found.append(Pid.step(sample, parameter, memory)[0])
    return np.array(found)


@pytest.mark.parametrize("first", [1.0, -1.0])
@pytest.mark.parametrize("n", [1, 5, 10])
def test_law_equals_its_transcription(first: float, n: int) -> None:
    time = np.arange(700) * 1e-3
    reference, velocity = 0.8 * np.sin(9 * time), 7.2 * np.cos(9 * time)
    # at rest from the start and between 0.3 and 0.4 s, where the gains of the last direction stay
    resting = (time < 0.1) | ((time > 0.3) & (time < 0.4))
    velocity = np.where(resting, 0.0, velocity)
    arm = reference + 0.01 * np.random.default_rng(3).standard_normal(700)
    assert commanded(reference, velocity, arm, first, n) == pytest.approx(transcribed(reference, velocity, arm, first, n))


def test_a_bumpless_change_of_gains_sums_the_error_with_the_gain_of_each_sample() -> None:
    time = np.arange(700) * 1e-3
    reference, velocity = 0.8 * np.sin(9 * time), 7.2 * np.cos(9 * time)
    arm = reference - 0.02
    found = commanded(reference, velocity, arm, 1.0, bumpless=1.0)
    integral = np.cumsum(np.where(velocity > 0, POSITIVE[1], NEGATIVE[1]) * 0.02) * 1e-3
    proportional = np.where(velocity > 0, POSITIVE[0], NEGATIVE[0]) * 0.02
    assert found == pytest.approx(8.5 * (proportional + integral))
    # without it the output jumps by the sum times the difference of the gains
    jumps = np.abs(np.diff(commanded(reference, velocity, arm, 1.0) - 8.5 * proportional))
    assert jumps.max() > 30 * np.abs(np.diff(found - 8.5 * proportional)).max()


def test_gains_at_rest_are_those_of_the_first_direction() -> None:
    still = np.full(1, 0.01)
    up, down = (commanded(still, np.zeros(1), np.zeros(1), first)[0] for first in (1.0, -1.0))
    assert up == pytest.approx(8.5 * 0.01 * (1.05 + 0.07))
    assert down == pytest.approx(8.5 * 0.01 * (1.4 + 0.09))


def test_compiled_law_gives_what_the_law_gives() -> None:
    time = np.arange(300) * 1e-3
    reference = np.column_stack([0.5 * np.sin(5 * time), 2.5 * np.cos(5 * time), -12.5 * np.sin(5 * time)])
    found = columns(reference, (0.36e6, 0.16e6), Pid, count=2 * np.pi / 1024)
    expected = transcribed(reference[:, 0], reference[:, 1], found["arm_deg"], 1.0)
    assert found["pid"] == pytest.approx(expected, rel=1e-12, abs=1e-12)
