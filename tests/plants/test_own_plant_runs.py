"""A user's plant runs under its inputs alone: against answers by hand, with and without a contact, at any period."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from plain_kernel import uncompiled

from hjcamp.effects import find_effect
from hjcamp.known_plants import find_plant
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Given
from hjcamp.model.run.simulator import Simulator


def simulator(name: str) -> Simulator:
    return Simulator(Composition(find_plant(name)), free=True)


def given(model: Simulator, period: float, samples: int, starts: list[list[float]], **inputs: np.ndarray) -> Given:
    """Return tests one after the other, ``samples`` long each, with equal inputs."""
    names = list(model.composition.inputs)
    columns = np.tile(model.inputs(), (samples * len(starts), 1))
    for name, values in inputs.items():
        columns[:, names.index(name)] = np.tile(values, len(starts))
    begins = np.zeros(len(columns), dtype=np.int64)
    begins[::samples] = 1
    time = np.tile(np.arange(samples) * period, len(starts))
    return Given(period, begins, time, columns, np.array(starts))


def test_a_carriage_speeds_up_slows_down_and_sticks(folder: Path) -> None:
    axis = simulator("axis")
    time = np.arange(4000) * 1e-3
    voltage = np.where(time < 2.0, 2.0, 0.3)
    test = given(axis, 1e-3, 4000, [[0.0, 0.0], [0.1, 0.0]], voltage=voltage)
    readings, states = axis.run_free(axis.vector({}), test)
    lag = 95.0 / 200.0
    fast = (2.0 * 35.0 - 20.0) / 200.0 * (1.0 - np.exp(-time[:2000] / lag))
    assert np.abs(states[:2000, 1] - fast).max() < 1e-6
    # it comes to rest under a push that is less than its friction, and stays there
    rest = (0.3 * 35.0 - 20.0) / 200.0
    stops = 2.0 + lag * np.log((fast[-1] - rest) / -rest)
    moving = states[:4000, 1] > 0.0
    assert time[moving][-1] == pytest.approx(stops, abs=2e-3)
    assert np.all(states[3000:4000, 1] == 0.0) and np.ptp(readings[3000:4000]) == 0.0
    assert np.allclose(readings[4000:, 0] - readings[:4000, 0], 0.1, atol=1e-9)


def test_a_contact_that_creeps_turns_as_an_independent_solution_does(folder: Path) -> None:
    from scipy.integrate import solve_ivp

    axis = uncompiled(Simulator(Composition(find_plant("axis"), (find_effect("contact_creep", "axis"),)), free=True))
    period, speed = 2e-3, 2e-3
    voltage = 0.9 * np.sin(30.0 * np.arange(150) * period)
    test = given(axis, period, 150, [[0.0, 0.0]], voltage=voltage)
    _, states = axis.run_free(axis.vector({"contact_creep.creep_speed": speed}), test)

    def rates(_: float, z: np.ndarray, push: float) -> list[float]:
        dry = 20.0 * np.sign(z[1]) * -np.expm1(-3.0 * abs(z[1]) / speed)
        return [z[1], (push - dry - 200.0 * z[1]) / 95.0]

    expected = np.zeros(2)
    for k in range(150):
        assert np.allclose(states[k], expected, atol=[2e-8, 2e-6])
        found = solve_ivp(rates, (0.0, period), expected, "LSODA", rtol=1e-10, atol=1e-14, args=(35.0 * voltage[k],))
        expected = found.y[:, -1]
    assert np.sum(states[2:, 1] * states[1:-1, 1] < 0.0) >= 2 and np.ptp(states[:, 0]) > 1e-5


def test_tanks_run_out_along_a_parabola(folder: Path) -> None:
    tanks = simulator("tanks")
    test = given(tanks, 4.0, 60, [[9.0, 0.5]], pump=np.zeros(60))
    readings, states = tanks.run_free(tanks.vector({}), test)
    level = np.maximum(3.0 - 0.05 * test.time / 2.0, 0.0) ** 2
    assert np.abs(states[:, 0] - level).max() < 1e-4
    assert np.allclose(readings[:, 0], states[:, 1], atol=1e-5) and readings.min() >= 0.0


def test_tanks_follow_an_independent_solution(folder: Path) -> None:
    from scipy.integrate import solve_ivp

    tanks = simulator("tanks")
    time = np.arange(100) * 4.0
    pump = 3.0 + 2.0 * np.sign(np.sin(time / 40.0))
    _, states = tanks.run_free(tanks.vector({}), given(tanks, 4.0, 100, [[2.0, 4.0]], pump=pump))
    expected = np.array([2.0, 4.0])
    for k in range(99):
        assert np.allclose(states[k], expected, atol=2e-5)
        found = solve_ivp(
            lambda _, x, inflow=0.05 * pump[k]: [
                inflow - 0.05 * np.sqrt(x[0]),
                0.05 * np.sqrt(x[0]) - 0.05 * np.sqrt(x[1]),
            ],
            (0.0, 4.0),
            expected,
            rtol=1e-10,
            atol=1e-12,
        )
        expected = found.y[:, -1]


MAGNET = '''"""A ball under a magnet."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, body, sensor


class Magnet(Plant):
    """The pull is in proportion to the square of the current over the gap."""

    gap = State("m", typical=0.01, low=0.001)
    velocity = State("m/s", typical=0.02)
    current = Input("A")
    mass = Parameter("kg", 0.07)
    magnet = Parameter("N*m^2/A^2", 1e-4, (1e-6, 1e-3), base=True)
    gap_mm = Measured("photocell", of="gap")

    @staticmethod
    def equations(state, parameter, drive, rate):
        ratio = drive.current / state.gap
        rate.gap = state.velocity
        rate.velocity = body(parameter.mass * 9.81 - parameter.magnet * ratio * ratio, mass=parameter.mass)
        photocell = sensor(state.gap)
'''


def test_what_is_curved_with_an_input_alone_is_followed(folder: Path) -> None:
    from scipy.integrate import solve_ivp

    # without a current nothing is curved: the plant's rates are linear where the input is at its default
    (folder / "plants" / "magnet.py").write_text(MAGNET)
    ball, period = uncompiled(simulator("magnet")), 2e-3
    time = np.arange(30) * period
    current = 0.87 + 0.1 * np.sin(80.0 * time)
    readings, _ = ball.run_free(ball.vector({}), given(ball, period, 30, [[0.0105, 0.0]], current=current))
    state = np.array([0.0105, 0.0])
    for k in range(30):
        assert readings[k, 0] == pytest.approx(state[0], abs=2e-7)
        found = solve_ivp(
            lambda _, x, i=current[k]: [x[1], 9.81 - 1e-4 / 0.07 * (i / x[0]) ** 2],
            (0.0, period),
            state,
            rtol=1e-11,
            atol=1e-14,
        )
        state = found.y[:, -1]


MIXER = '''"""A stirred tank."""
from hjcamp.plant import Input, Measured, Parameter, Plant, State, path, sensor, store


class Mixer(Plant):
    r"""What flows in takes the place of what was there.

    .. math:: \\dot T = (q / V)\\,(T_{in} - T)
    """

    warmth = State("K", typical=20.0)
    flow = Input("m^3/s", typical=1e-3, default=0.0)
    volume = Parameter("m^3", 0.02, base=True)
    inlet = Parameter("K", 60.0)
    period = 5.0
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.warmth = drive.flow / parameter.volume * (parameter.inlet - state.warmth)
        probe = sensor(state.warmth)
'''


def test_an_input_that_multiplies_a_state_is_followed_as_exactly_as_a_coefficient(folder: Path) -> None:
    (folder / "plants" / "mixer.py").write_text(MIXER, encoding="utf-8")
    model = uncompiled(simulator("mixer"))
    flow = np.where(np.arange(40) < 20, 2e-3, 6e-3)
    _, states = model.run_free(model.vector({}), given(model, 5.0, 40, [[10.0]], flow=flow))
    passed = np.concatenate([[0.0], np.cumsum(5.0 * flow / 0.02)[:-1]])
    # a step of 5 s is half a time constant, and more: a step by Euler would err by kelvins
    assert np.abs(states[:, 0] - (60.0 - 50.0 * np.exp(-passed))).max() < 2e-3
