"""What a driven contact drags along is stepped with a linear part of its speed: a step may be many of its times of decay long."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hjcamp.effects import load_effects
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Course
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint

PERIOD, SAMPLES = 1e-3, 600


def swinging() -> Course:
    """Return measured motion of the sliders, up to 60 mm/s both ways, in straight lines between samples."""
    time = np.arange(SAMPLES) * PERIOD
    track = 2e-3 * np.sin(30.0 * time)
    driven = np.column_stack([np.zeros(SAMPLES), np.full(SAMPLES, 0.3e6), np.full(SAMPLES, 0.2e6), track])
    restart = np.ones(SAMPLES, dtype=np.int64)
    restart[0] = 2
    velocity = np.append(np.diff(track), 0.0) / PERIOD
    return Course(PERIOD, restart, time, driven, driven, velocity[:, None], inputs_along(PumpJoint, SAMPLES))


def stiff_bristles(compliance: float) -> tuple[Simulator, dict[str, float]]:
    """Return bristles on driven sliders, whose friction does not fall with slip."""
    presliding = load_effects([])["presliding"]
    simulator = Simulator(Composition(PumpJoint, (presliding,), PumpJoint.cut("inverse")))
    values = {f"presliding.{name}": one.default for name, one in presliding.parameters.items()}
    values |= {"presliding.compliance": compliance, "presliding.fall_velocity": 10.0}
    for side in ("positive", "negative"):
        values |= {f"static_{side}": 3.0, f"coulomb_{side}": 3.0, f"viscous_{side}": 20.0}
    return simulator, values


def friction_of(course: Course, compliance: float, values: dict[str, float]) -> np.ndarray:
    """Return the friction (N) of three bristles by SciPy's LSODA: dq/dt = v (1 - r^2) where r v > 0, else v."""
    level, shares = 3.0, np.array([0.2, 1.0, 1.8])
    push = (course.driven[0, 1] - course.driven[0, 2]) * PumpJoint.parameters["joint_area"].default
    deflection, found = compliance * shares * push, []
    speeds = np.append(np.diff(course.driven[:, 3]), 0.0) / PERIOD
    damping = 2.0 * np.sqrt(PumpJoint.parameters["moving_mass"].default / compliance)
    for speed in speeds:

        def rate(_: float, q: np.ndarray, speed: float = speed) -> np.ndarray:
            share = q / (compliance * shares * level)
            return speed * (1.0 - np.where(speed * share > 0.0, share**2, 0.0))

        force = np.mean(deflection / (compliance * shares))
        slip = min((force / level) ** 2, 1.0) if speed * force > 0.0 else 0.0
        found.append(force + damping * speed * (1.0 - slip) + values["viscous_positive"] * speed)
        deflection = solve_ivp(rate, (0.0, PERIOD), deflection, method="LSODA", rtol=1e-9, atol=1e-15).y[:, -1]
    return np.array(found)


@pytest.mark.parametrize("compliance", [2e-6, 2e-5])
def test_stiff_bristles_on_driven_sliders_take_few_steps_and_are_right(compliance: float) -> None:
    course, (simulator, values) = swinging(), stiff_bristles(compliance)
    found = simulator.follow(simulator.vector(values), course)
    # 23 steps a sample for the stiffer ones where the linear part was that of rest
    assert found.steps < 3 * SAMPLES
    friction = found.forces[:, list(PumpJoint.balance).index("friction")]
    expected = friction_of(course, compliance, values)
    # how a test begins is soon forgotten, and with its last sample the motion ends
    assert np.abs(friction - expected)[20:-1].max() < 0.03
    assert np.ptp(expected) > 5.0
