"""What is exported for MuJoCo: joint and actuator values by hand, what they cannot express, and MuJoCo's own rollout."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from answer_schemas import check_answer
from plant_texts import ROTOR, TANKS

from hjcamp import cli
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.effects import library_of
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.plant import Plant
from hjcamp.model.export.joint_values import Joint, Mapped, mapped
from hjcamp.model.export.mujoco_file import mujoco_file
from hjcamp.model.export.python_file import Exported, python_file

# A wheel that a spring of the plant's own holds, driven behind a lag of 20 ms; its sensor reads the speed.
WHEEL = '''"""A wheel."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, sensor


class Wheel(Plant):
    """A wheel that a spring holds."""

    angle = State("rad", typical=1.0)
    speed = State("rad/s", typical=5.0)
    current = State("A", typical=2.0)
    command = Input("V", typical=3.0)
    speed_rad_per_s = Measured("tacho", of="speed")
    inertia = Parameter("kg*m^2", 2e-3)
    viscous = Parameter("N*m*s", 4e-3)
    stiffness = Parameter("N*m", 0.3)
    slope = Parameter("A/V", 0.5)
    torque_of = Parameter("N*m/A", 0.1)
    lag = Parameter("s", 0.02)
    rest = Parameter("rad", 0.4)

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.current = (parameter.slope * drive.command - state.current) / parameter.lag
        torque = actuator(parameter.torque_of * state.current)
        rate.angle = state.speed
        rate.speed = body(
            torque - parameter.viscous * state.speed - parameter.stiffness * (state.angle - parameter.rest),
            mass=parameter.inertia, position=state.angle,
        )
        tacho = sensor(state.speed)
'''
# Of the range: MuJoCo steps by a rule of first order, and holds rest softly.
CLOSE = 0.01
CARRIAGE = {"inertia": 95.0, "damping": 200.0, "frictionloss": 20.0, "stiffness": 0.0, "offset": 0.0}


def plant_of(text: str, name: str) -> type[Plant]:
    Path("plants").mkdir(exist_ok=True)
    Path(f"plants/{name}.py").write_text(text, encoding="utf-8")
    return find_plant(name)


def exported(plant: type[Plant], **effects: dict[str, float]) -> Exported:
    library = library_of(plant, imposed=True).effects
    values = {f"{effect}.{name}": value for effect, own in effects.items() for name, value in own.items()}
    return Exported(Composition(plant, tuple(library[name] for name in effects)), values)


def found(one: Exported) -> tuple[Joint, Mapped]:
    whole = mapped(one)
    [joint] = whole.joints
    return joint, whole


@pytest.mark.parametrize(
    ("effects", "changed", "lag"),
    [
        ({}, {}, 0.0),
        ({"constant_force": {"strength": 7.0}}, {"offset": 7.0}, 0.0),
        ({"spring": {"stiffness": 300.0, "rest_position": 0.05}}, {"stiffness": 300.0, "offset": 15.0}, 0.0),
        ({"spring": {"stiffness": -50.0, "rest_position": 0.0}}, {"stiffness": -50.0}, 0.0),
        ({"action_lag": {"lag": 0.03}}, {}, 0.03),
    ],
)
def test_values_are_those_that_the_equations_have_by_hand(
    carriage: type[Plant], effects: dict[str, dict[str, float]], changed: dict[str, float], lag: float
) -> None:
    one, whole = found(exported(carriage, **effects))
    assert {name: getattr(one, name) for name in CARRIAGE} == pytest.approx(CARRIAGE | changed, rel=1e-8, abs=1e-9)
    [drive] = one.drives
    assert (drive.given, drive.gain, drive.lag) == ("voltage", pytest.approx(35.0), pytest.approx(lag))
    assert one.kind == "slide" and whole.readings == {"encoder": ("position", False)} and whole.lost == ()


@pytest.mark.parametrize(
    "name", ["cubic_spring", "stribeck_excess", "coulomb_asymmetry", "hard_stop", "presliding", "friction_drift", "sensor_lag",
             "static_friction_ageing", "dead_band", "saturation", "maxwell_element"]
)  # fmt: skip
def test_an_effect_that_no_joint_has_is_left_out_and_said(carriage: type[Plant], name: str) -> None:
    one, whole = found(exported(carriage, **{name: {}, "constant_force": {"strength": 7.0}}))
    assert {key: getattr(one, key) for key in CARRIAGE} == pytest.approx(CARRIAGE | {"offset": 7.0}, rel=1e-8, abs=1e-9)
    [sentence] = whole.lost
    assert sentence.startswith(f"effect {name}: ")


def test_what_the_plant_has_beyond_a_joint_is_said(carriage: type[Plant]) -> None:
    text = TEMPLATE.format(title="Carriage").replace(
        "coulomb=parameter.coulomb,", "coulomb=parameter.coulomb, static=1.5 * parameter.coulomb,"
    )
    text = text.replace("parameter.gain * drive.voltage)", "limited(parameter.gain * drive.voltage, -40.0, 40.0))")
    text = text.replace("sensor(state.position)", "sensor(2.0 * state.position)").replace(
        "import Input", "import limited, Input"
    )
    one = exported(plant_of(text.replace("class Carriage", "class Slide"), "slide"))
    _, whole = found(Exported(one.composition, {}, {"voltage": 0.0015}))
    said = " | ".join(whole.lost)
    parts = (
        "breaks away at 30 N and slides at 20",
        "no straight law",
        "reading 'encoder'",
        "within -40.0 and 40.0",
        "0.0015 s later",
    )
    assert [part for part in parts if part not in said] == []


@pytest.mark.parametrize(
    ("text", "name", "said"),
    [(TANKS, "tanks", "no state in m/s or rad/s is a body"), (ROTOR, "rotor", "state 'pressure' pushes body 'speed'")],
)
def test_a_plant_that_is_no_joint_is_refused_in_a_line(carriage: type[Plant], text: str, name: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        mapped(exported(plant_of(text, name)))


def test_the_command_writes_a_file_that_parses_and_says_what_is_lost(
    carriage: type[Plant], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("conf/model").mkdir(parents=True)
    saved = (
        "name: fitted\nplant: carriage\nparameters: {coulomb: 33.0}\neffects: {cubic_spring: {}, spring: {stiffness: 40.0}}\n"
    )
    Path("conf/model/fitted.yaml").write_text(saved, encoding="utf-8")
    assert cli.run(["model", "export", "fitted", "--as", "mujoco", "--json", "answer.json"]) == 0
    answer = json.loads(Path("answer.json").read_text())
    check_answer(answer)
    assert "not expressed: effect cubic_spring" in capsys.readouterr().out.replace("\n", " ")
    root = ET.parse("fitted.xml").getroot()
    joint, inertial = root.find("worldbody/body/joint"), root.find("worldbody/body/inertial")
    assert joint is not None and joint.attrib | {"damping": "200", "frictionloss": "33"} == joint.attrib
    assert inertial is not None and inertial.get("mass") == "95"
    assert joint.get("stiffness") == "40" and answer["joints"][0]["frictionloss"] == pytest.approx(33.0)
    assert "cubic_spring" in answer["not_expressed"][0] and "cubic_spring" in Path("fitted.xml").read_text()


def rolled_out(text: str, commands: np.ndarray) -> np.ndarray:
    """Return what MuJoCo's sensor reads before each command acts."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is no dependency: its rollout is compared where it is installed")
    model = mujoco.MjModel.from_xml_string(text)
    data, readings = mujoco.MjData(model), np.empty(len(commands))
    for k, command in enumerate(commands):
        data.ctrl[:1] = command
        mujoco.mj_forward(model, data)
        readings[k] = data.sensordata[0]
        mujoco.mj_step(model, data)
    return readings


@pytest.mark.parametrize(
    "effects",
    [{}, {"spring": {"stiffness": 300.0, "rest_position": 0.05}, "action_lag": {"lag": 0.03}},
     {"constant_force": {"strength": 7.0}}],
)  # fmt: skip
def test_mujoco_moves_as_the_simulator_does(carriage: type[Plant], effects: dict[str, dict[str, float]]) -> None:
    one = exported(carriage, **effects)
    time = np.arange(2000) * 1e-3
    volts = 6.0 * np.sin(2.0 * np.pi * 1.5 * time) * (time % 0.8 < 0.55)
    assert difference(moved(one, "voltage", volts), rolled_out(mujoco_file(one, mapped(one)), volts)) < CLOSE


def test_a_wheel_behind_a_lag_moves_so_too(carriage: type[Plant]) -> None:
    one = exported(plant_of(WHEEL, "wheel"))
    joint, whole = found(one)
    assert (joint.kind, joint.stiffness, joint.offset) == ("hinge", pytest.approx(0.3), pytest.approx(0.12))
    assert [(each.gain, each.lag) for each in joint.drives] == [(pytest.approx(0.05), pytest.approx(0.02))] and not whole.lost
    volts = np.repeat(np.random.default_rng(1).uniform(-3.0, 3.0, 40), 50)
    assert difference(moved(one, "command", volts), rolled_out(mujoco_file(one, whole), volts)) < CLOSE


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """Return the largest difference of two courses as a share of the range of the first."""
    return float(abs(one - other).max() / np.ptp(one))


def moved(one: Exported, given: str, commands: np.ndarray) -> np.ndarray:
    """Return the reading that the simulator gives, as the exported file has it."""
    names: dict[str, object] = {}
    exec(python_file(one), names)
    readings, _ = names["simulate"]({given: commands})  # type: ignore[operator]
    return next(iter(readings.values()))
