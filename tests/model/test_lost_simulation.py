"""A simulation that leaves the finite numbers stops there: it is not tried at every step length for the rest of the test."""

from __future__ import annotations

import numpy as np
import pytest
from plain_kernel import uncompiled

from hjcamp.model.compile.compose import Composition
from hjcamp.model.run.simulator import Given, Simulator
from hjcamp.plant import Input, Measured, Parameter, Plant, State, sensor

PERIOD = 0.1


class Runaway(Plant):
    """A level that grows with its square: 1 / (1 - t) from 1, infinite at t = 1 s."""

    name = "runaway"
    level = State("1", resolution=1e-6, typical=1.0)
    given = Input("1")
    pace = Parameter("1/s", 1.0, base=True)
    level_1 = Measured("gauge", of="level")

    @staticmethod
    def equations(state, parameter, drive, rate):  # type: ignore[no-untyped-def]
        rate.level = parameter.pace * state.level * state.level + 0.0 * parameter.pace * drive.given
        gauge = sensor(state.level)  # noqa: F841 - read, not run


@pytest.fixture(scope="module")
def simulator() -> Simulator:
    return uncompiled(Simulator(Composition(Runaway), free=True))


def run(simulator: Simulator, samples: int, begins: tuple[int, ...] = (0,)) -> tuple[np.ndarray, float]:
    """Return the level at each sample and the steps that were taken; tests begin at the samples ``begins``."""
    p, z, work = simulator.vector({}), np.ones(1), simulator.scratch()
    marks, starts = np.zeros(samples, dtype=np.int64), np.ones((len(begins), 1))
    marks[list(begins)] = 1
    out, states, ends = np.empty((samples, 1)), np.empty((samples, 1)), np.empty((len(begins), 1))
    time, given = np.arange(samples) * PERIOD, np.zeros((samples, 1))
    with np.errstate(all="ignore"):
        simulator.kernel.run_free(
            z,
            simulator.inputs(),
            p,
            *simulator.propagators(z, p),
            PERIOD,
            marks,
            time,
            given,
            starts,
            out,
            states,
            ends,
            work,
        )
    return states[:, 0], work[2, 1]


def test_it_stops_at_once_and_takes_no_further_step(simulator: Simulator) -> None:
    level, steps = run(simulator, 15)
    expected = 1.0 / (1.0 - np.arange(9) * PERIOD)
    assert level[:9] == pytest.approx(expected, rel=1e-4)
    assert np.all(np.isnan(level[12:]))
    longer, as_many = run(simulator, 400)
    assert as_many == steps
    assert np.all(np.isnan(longer[12:]))


def test_the_next_test_begins_anew(simulator: Simulator) -> None:
    level, _ = run(simulator, 28, (0, 20))
    assert np.all(np.isnan(level[12:20]))
    np.testing.assert_array_equal(level[20:28], level[:8])


def test_a_model_that_needs_more_steps_than_it_may_take_is_left_there(simulator: Simulator) -> None:
    begins = np.zeros(8, dtype=np.int64)
    begins[0] = 1
    given = Given(PERIOD, begins, np.arange(8) * PERIOD, np.zeros((8, 1)), np.ones((1, 1)))
    whole, _, _, steps = simulator.run_to_ends(simulator.vector({}), given)
    assert np.all(np.isfinite(whole)) and steps > 8
    part, states, _, taken = simulator.run_to_ends(simulator.vector({}), given, most=0.5 * steps)
    known = np.isfinite(part[:, 0])
    assert 0 < known.sum() < 8 and np.all(np.isnan(states[~known]))
    assert np.array_equal(part[known], whole[known]) and 0.5 * steps < taken < steps
