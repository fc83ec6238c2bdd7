"""Two pumps against calculations by hand (further plants, B.6)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from hjcamp.backends import plant_simulation
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer
from hjcamp.model.compile.compose import Composition
from hjcamp.model.run.simulator import Given, Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.two_pumps.plant import TwoPumps

PERIOD = TwoPumps.period
PUMP_AREA, JOINT_AREA = math.pi / 4 * 6.35e-3**2, math.pi / 4 * 4e-3**2
STIFFNESS, LEAD = 2.57e13, 1e-3 / (2 * math.pi)
N = 600
TIME = np.arange(N) * PERIOD
TURN = 8.5 * np.radians(40.0) * np.sin(2 * np.pi * 1.5 * TIME)  # rad of a motor


@pytest.fixture(scope="module")
def pair() -> Simulator:
    """The two pumps under given commands."""
    return Simulator(Composition(TwoPumps), free=True)


def run(
    model: Simulator,
    commands: Mapping[str, np.ndarray],
    start: Mapping[str, float],
    values: Mapping[str, float] | None = None,
) -> dict[str, np.ndarray]:
    """Return the states of a run under commands."""
    inputs = np.tile(model.inputs(), (N, 1))
    for name, column in commands.items():
        inputs[:, model.composition.inputs.index(name)] = column
    begins = np.zeros(N, dtype=np.int64)
    begins[0] = 1
    begin = np.array([[start.get(name, 0.0) for name in model.states]])
    states = model.run_free(model.vector(values or {}), Given(PERIOD, begins, TIME, inputs, begin))[1]
    return dict(zip(model.states, states.T, strict=True))


HIGH = {"pressure1": 0.5e6, "pressure2": 0.5e6}  # no line comes near the floor


@pytest.mark.study
def test_opposite_commands_are_the_one_pump_joint(pair: Simulator) -> None:
    """Every state equals the one-pump joint's, from the same start: pump 2 is pump 1 backwards."""
    single = run(Simulator(Composition(PumpJoint), free=True), {"command": TURN}, HIGH)
    found = run(pair, {"command1": TURN, "command2": -TURN}, HIGH)
    assert np.ptp(single["slider_position"]) > 1e-3
    for one, other in (("pressure1", "pressure1"), ("pressure2", "pressure2"), ("slider_position", "slider_position")):
        assert found[other] == pytest.approx(single[one], abs=2e-4 * np.ptp(single[one]))
    assert found["pump1_position"] == pytest.approx(single["pump_position"], abs=1e-8)
    assert found["pump2_position"] == pytest.approx(-single["pump_position"], abs=1e-8)


def test_a_common_command_leaves_the_arm_and_moves_the_mean(pair: Simulator) -> None:
    """With equal lines c(t) changes the mean by K A1 c and not the arm."""
    common = np.radians(60.0) * np.sin(2 * np.pi * 2.0 * TIME)
    alone = run(pair, {"command1": TURN, "command2": -TURN}, HIGH)
    both = run(pair, {"command1": TURN + common, "command2": common - TURN}, HIGH)
    assert both["slider_position"] == pytest.approx(alone["slider_position"], abs=2e-4 * np.ptp(alone["slider_position"]))
    mean = 0.5 * (both["pressure1"] + both["pressure2"])
    travel = 0.5 * (both["pump1_position"] + both["pump2_position"])
    assert mean - mean[0] == pytest.approx(STIFFNESS * PUMP_AREA * travel, abs=200.0)
    assert np.ptp(mean) > 0.1e6


def test_a_weaker_second_pump_lets_the_mean_drift(pair: Simulator) -> None:
    """The mean drifts by K A1 eps x2 / 2, 0.023 MPa for 2 % at 120 deg, and comes back with the travel."""
    found = run(pair, {"command1": TURN, "command2": -TURN}, HIGH, {"mismatch": 0.02})
    mean = 0.5 * (found["pressure1"] + found["pressure2"])
    assert mean - mean[0] == pytest.approx(0.5 * STIFFNESS * PUMP_AREA * 0.02 * found["pump2_position"], abs=100.0)
    travel = np.radians(120.0) * 8.5 * LEAD
    assert 0.5 * STIFFNESS * PUMP_AREA * 0.02 * travel * 1e-6 == pytest.approx(0.023, abs=5e-4)


def test_unequal_lines_turn_the_common_command_into_a_difference(pair: Simulator) -> None:
    """K1 != K2: c changes p1 - p2 by (K1 - K2) A1 c while the arm rests."""
    common = np.radians(30.0) * np.sin(2 * np.pi * 2.0 * TIME)
    found = run(pair, {"command1": common, "command2": common}, HIGH, {"stiffness_asymmetry": 0.1})
    assert not np.any(found["slider_position"])
    change = found["pressure1"] - found["pressure2"]
    assert change == pytest.approx(0.1 * STIFFNESS * PUMP_AREA * found["pump1_position"], abs=50.0)
    assert np.ptp(change) > 5e3


def test_the_gain_matrix_decouples(pair: Simulator) -> None:
    """From (theta1, theta2) to (p1 - p2, mean): K A1 l [[1, -1], [1/2, 1/2]] with the arm held."""
    held = {f"{kind}_{side}": 60.0 for kind in ("static", "coulomb") for side in ("positive", "negative")}
    rows = []
    for one, other in ((1.0, 0.0), (0.0, 1.0)):
        found = run(pair, {"command1": np.full(N, one), "command2": np.full(N, other)}, HIGH, held)
        p1, p2 = found["pressure1"][-1] - 0.5e6, found["pressure2"][-1] - 0.5e6
        rows.append([p1 - p2, 0.5 * (p1 + p2)])
    gain = np.array(rows).T / (STIFFNESS * PUMP_AREA * LEAD)
    assert gain == pytest.approx(
        np.array([[1.0, -1.0], [0.5, 0.5]]), rel=2e-3
    )  # the printed numerator gives 1 mm a turn to 0.2 %
    assert np.linalg.cond(gain) == pytest.approx(2.0, rel=5e-3)
    relative = gain * np.linalg.inv(gain).T
    assert relative == pytest.approx(np.full((2, 2), 0.5), abs=5e-3)


def test_needed_means() -> None:
    """p_low + Fs / (2 A2): 0.386 MPa upward, 0.260 MPa downward keep 0.1 MPa at breakaway."""
    assert [round(0.1 + 1e-6 * force / (2 * JOINT_AREA), 3) for force in (7.20, 4.03)] == [0.386, 0.26]


def held(composer: Composer, *more: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean pressure and that of line 1 (MPa) of a test at rest in which line 1 leaks."""
    lines = ["plant=two_pumps", "trajectory=hold", "trajectory.duration=3", "++parameters.loss1=2e-15", "plant.noise=0"]
    config: Any = composer.compose([*lines, "plant.scatter=0", *more]).config
    check_configuration(config)
    columns = plant_simulation.run_test(config, 1)[0]
    line1, line2 = (columns[name][columns["phase"] == 3.0] for name in ("pressure1_mpa", "pressure2_mpa"))
    return 0.5 * (line1 + line2), line1


def test_an_integral_part_makes_a_leak_good(composer: Composer) -> None:
    """A leak of conductance g: the mean falls as t without the integral part, with it its steady error is 0 for a pump that follows."""
    regulated, _ = held(composer, "controller=sum_difference")
    left, line1 = held(composer, "controller=sum_difference", "controller.mean_ki=0")
    lost = left[1500] - left[-1]
    assert lost == pytest.approx(0.5 * STIFFNESS * 2e-15 * float(np.sum(line1[1500:-1])) * PERIOD, rel=0.02)
    assert lost > 0.01
    assert abs(regulated[-1] - regulated[1500]) < 0.05 * lost
