"""Play between two bodies that a shaft joins is a dead zone of its twist; the rig is stepped here, with a contact of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

PERIOD, PARTS, PLAY = 0.005, 25, 0.04
MOTOR, LOAD, STIFFNESS, DAMPING, DRY, MOTOR_VISCOUS, LOAD_VISCOUS = 0.033, 0.1, 75.0, 0.15, 0.2, 0.15, 0.05
PLANT = '''"""A motor turns a load over a shaft."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, sensor, transmission


class Gearbox(Plant):
    """A motor, a gear, an elastic shaft, a load."""

    motor_angle = State("rad", typical=1.0)
    motor_speed = State("rad/s", typical=3.0)
    load_angle = State("rad", typical=1.0)
    load_speed = State("rad/s", typical=3.0)
    torque = Input("N*m")
    motor_inertia = Parameter("kg*m^2", 0.04, (1e-3, 1.0), base=True)
    load_inertia = Parameter("kg*m^2", 0.08, (1e-3, 1.0), base=True)
    motor_coulomb = Parameter("N*m", 0.25, (0.0, 5.0), base=True)
    motor_viscous = Parameter("N*m*s/rad", 0.12, (0.0, 5.0), base=True)
    load_viscous = Parameter("N*m*s/rad", 0.06, (0.0, 5.0), base=True)
    stiffness = Parameter("N*m/rad", 60.0, (1.0, 1e4), base=True)
    damping = Parameter("N*m*s/rad", 0.10, (0.0, 10.0), base=True)
    motor_angle_rad = Measured("motor_encoder", of="motor_angle")
    load_angle_rad = Measured("load_encoder", of="load_angle")
    period = 0.005

    @staticmethod
    def equations(state, parameter, drive, rate):
        drive_torque = actuator(drive.torque)
        gear = transmission(state.motor_angle)
        bent = parameter.stiffness * (gear - state.load_angle)
        shaft = bent + parameter.damping * (state.motor_speed - state.load_speed)
        bearing = contact(state.motor_speed, coulomb=parameter.motor_coulomb, viscous=parameter.motor_viscous)
        rate.motor_angle = state.motor_speed
        rate.motor_speed = body(drive_torque - shaft - bearing, mass=parameter.motor_inertia)
        rate.load_angle = state.load_speed
        rate.load_speed = body(shaft - parameter.load_viscous * state.load_speed, mass=parameter.load_inertia)
        motor_encoder = sensor(state.motor_angle)
        load_encoder = sensor(state.load_angle)
'''


def rates(state: np.ndarray, torque: float) -> np.ndarray:
    """Return the rates of both angles and speeds: flanks that push and never pull, friction that is smooth."""
    twist, slip = state[0] - state[2], state[1] - state[3]
    passed = 0.0
    if twist > 0.5 * PLAY:
        passed = max(STIFFNESS * (twist - 0.5 * PLAY) + DAMPING * slip, 0.0)
    elif twist < -0.5 * PLAY:
        passed = min(STIFFNESS * (twist + 0.5 * PLAY) + DAMPING * slip, 0.0)
    braked = DRY * np.tanh(state[1] / 0.01) + MOTOR_VISCOUS * state[1]
    return np.array([state[1], (torque - passed - braked) / MOTOR, state[3], (passed - LOAD_VISCOUS * state[3]) / LOAD])


def log(name: str, torque: np.ndarray) -> TestLog:
    """Return a log of both encoders, 20,000 counts a turn."""
    state, shown, step = np.zeros(4), np.empty((len(torque), 2)), PERIOD / PARTS
    for k, given in enumerate(torque):
        shown[k] = state[[0, 2]]
        for _ in range(PARTS):
            first = rates(state, given)
            second = rates(state + 0.5 * step * first, given)
            third = rates(state + 0.5 * step * second, given)
            state = state + step / 6.0 * (first + 2.0 * second + 2.0 * third + rates(state + step * third, given))
    count = 2.0 * np.pi / 20000
    noisy = np.round((shown + count / 3 * np.random.default_rng(4).standard_normal(shown.shape)) / count) * count
    columns = {"time_s": PERIOD * np.arange(len(torque)), "torque_nm": torque}
    columns |= {"motor_angle_rad": noisy[:, 0], "load_angle_rad": noisy[:, 1]}
    return TestLog(columns, {"plant": "gearbox", "period_s": str(PERIOD), "condition": name})


@pytest.fixture
def geared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    """Two logs of a shaft with play: torque to and fro, and levels drawn at random."""
    monkeypatch.chdir(tmp_path)
    Path("plants").mkdir()
    Path("plants/gearbox.py").write_text(PLANT, encoding="utf-8")
    time = PERIOD * np.arange(500)
    levels = np.repeat(np.random.default_rng(7).uniform(-1.8, 1.8, 10), 50)
    square = 1.6 * np.sign(np.sin(2.0 * np.pi * 0.9 * time)) * (1.0 - 0.2 * time)
    return measured_tests([log("to_and_fro", square), log("levels", levels)])


def test_play_in_a_shaft_is_named_with_its_width(geared: Measured) -> None:
    library = load_effects(plant=geared.plant)
    backlash = library["backlash"]
    # the shaft tells where the load is: nothing has to be remembered
    assert not backlash.states and set(backlash.terms["gear"].arguments) == {"gear", "gear_input", "load_angle", "play"}
    names = ("backlash", "dead_band", "dry_friction", "sensor_gain_at_load_encoder", "stribeck_excess")
    found = decided(calibrated(geared, {name: library[name] for name in names if name in library}, unknowns=False))
    assert (found.word, found.effects) == ("effect", ("backlash",))
    model = found.model.fitted.candidate
    assert model.effects["backlash"]["play"] == pytest.approx(PLAY, rel=0.03)
    assert model.base["stiffness"] == pytest.approx(STIFFNESS, rel=0.1)


def test_a_free_law_of_the_twist_is_as_large_as_that(geared: Measured) -> None:
    # the slope of a fit is a hundredth of the size: of the whole turn it would be more than all of the twist
    ranges = {"gear": (-1.0, 3.0), "gear_input": (-1.0, 3.0), "gear_twist": (-0.02, 0.01)}
    found = unknowns_of(geared.plant, ranges)
    assert found["unknown_output_over_twist"].usual == pytest.approx(0.02)
    assert found["unknown_output_over_input"].usual == pytest.approx(3.0)
