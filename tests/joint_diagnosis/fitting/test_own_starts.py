"""What a test begins with is found for each test on its own, and does not hide what all tests share."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State
from hjcamp.plants.pump_joint.diagnosis.models.per_test_states import OwnStarts, own_moves, step_within
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import effect_unknowns

TESTS, SAMPLES = 3, 400
EDGES = np.arange(TESTS + 1) * SAMPLES
LEAST = 0.01


def decay() -> np.ndarray:
    """A start that is forgotten, seen in the first of two channels."""
    time = np.tile(np.linspace(0.0, 4.0, SAMPLES), TESTS)
    return np.column_stack([np.exp(-time), np.zeros(len(time))])


def test_each_test_has_its_own_start() -> None:
    generator = np.random.default_rng(4)
    moves = np.array([0.05, -0.2, 0.0])
    noise = 0.02 * generator.standard_normal((TESTS * SAMPLES, 2))
    residual = noise - decay() * np.repeat(moves, SAMPLES)[:, None]
    found = own_moves(residual, decay(), EDGES, LEAST, (-1.0, 1.0))
    assert found == pytest.approx(moves, abs=5e-3)


def test_a_start_stays_within_its_room() -> None:
    residual = -0.7 * decay()
    found = own_moves(residual, decay(), EDGES, LEAST, (-0.5, 0.3))
    assert found == pytest.approx([0.3] * TESTS)


def test_what_the_start_does_not_touch_moves_nothing() -> None:
    residual = np.ones((TESTS * SAMPLES, 2))
    assert own_moves(residual, np.zeros_like(residual), EDGES, LEAST, (-1.0, 1.0)) == pytest.approx([0.0] * TESTS)


def test_a_loud_channel_does_not_drown_the_one_that_tells() -> None:
    generator = np.random.default_rng(5)
    residual = np.column_stack([np.zeros(TESTS * SAMPLES), 5.0 * generator.standard_normal(TESTS * SAMPLES)])
    residual[:, 0] = -0.1 * decay()[:, 0] + 0.01 * generator.standard_normal(TESTS * SAMPLES)
    response = np.column_stack([decay()[:, 0], decay()[:, 0]])
    assert own_moves(residual, response, EDGES, LEAST, (-1.0, 1.0)) == pytest.approx([0.1] * TESTS, abs=0.01)


@pytest.mark.parametrize(("value", "step"), [(1.0, -0.1), (0.0, 0.1), (0.95, -0.1), (0.5, 0.1)])
def test_a_step_stays_within_the_bounds(value: float, step: float) -> None:
    assert step_within(value, (0.0, 1.0)) == pytest.approx(step)


class Tube(Effect):
    """A tube that forgets how it began."""

    subsystem = "lines"
    share = Parameter("1", 0.2, (0.0, 1.0), off=0.0)
    begun = Parameter("1", 0.8, (0.0, 1.0), each_test=True)
    volume = State("m^3", 1e-13, 1e-9)

    @staticmethod
    def start_volume(begun):
        """Begin, m^3."""
        return begun

    @staticmethod
    def d_volume(volume):
        """Forget, m^3/s."""
        return -volume

    @staticmethod
    def leak1(volume, share):
        """Flow, m^3/s."""
        return share * volume


Tube.name = "tube"


def test_the_shared_value_becomes_the_mean_and_each_test_keeps_its_own() -> None:
    true = np.array([0.9, 0.6, 0.75])
    size = 3000.0

    def line_errors(candidate: Candidate) -> np.ndarray:
        value = candidate.effects["tube"]["begun"]
        return size * decay() * (value - np.repeat(true, SAMPLES))[:, None]

    starts = OwnStarts([Tube], EDGES, line_errors)
    candidate = Candidate({}, {"tube": {"share": 0.2, "begun": 0.8}})
    left = line_errors(candidate)
    assert np.abs(left + starts.corrections(candidate, left)).max() < 1e-6 * size
    assert starts.centred(candidate).effects["tube"]["begun"] == pytest.approx(true.mean())
    assert starts.corrections(Candidate({}), left) == 0.0
    assert [one.name for one in effect_unknowns(Tube)] == ["share"]
