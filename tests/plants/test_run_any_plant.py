"""`hjcamp run` for a plant of the user's: a free run, a loop with a controller of his own, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.backends import plant_simulation, schedule
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer, free
from hjcamp.errors import UsageError
from hjcamp.records.read import read_log

LEAD = '''"""Position and speed of a carriage, fed back."""

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.parameter import Parameter


class Lead(Controller):
    """A voltage from the error and its slope."""

    samples = ("reference", "velocity", "position", "period")
    results = ("voltage",)
    stiffness = Parameter("V/m", 200.0, (0.0, 1e5))
    damping = Parameter("V*s/m", 30.0, (0.0, 1e4))
    last = Memory()

    @staticmethod
    def step(sample, parameter, memory):
        slope = (sample.position - memory.last) / sample.period
        memory.last = sample.position
        return parameter.stiffness * (sample.reference - sample.position) + parameter.damping * (sample.velocity - slope)
'''


@pytest.fixture
def bench(folder: Path) -> Path:
    """A user's folder with plants, a controller and its configuration."""
    (folder / "controllers").mkdir()
    (folder / "controllers" / "lead.py").write_text(LEAD)
    (folder / "conf" / "controller").mkdir(parents=True)
    (folder / "conf" / "controller" / "lead.yaml").write_text("name: lead\nstiffness: 200.0\n")
    return folder


def made(*lines: str) -> dict[str, Any]:
    """Return the checked configuration of one test."""
    config: dict[str, Any] = Composer().compose([free(line) for line in lines]).config
    check_configuration(config)
    return config


def test_tanks_are_filled_by_a_given_voltage(bench: Path, capsys: pytest.CaptureFixture[str]) -> None:
    steps = "trajectory.segments=[{to_v: 4, in: 0.1, law: linear}, {rest: 0.9}]"
    call = ["run", "plant=tanks", "trajectory=segments", steps, "parameters.k4=0.5", "repetitions=1", "run_dir=out"]
    assert cli.run(call) == 0, capsys.readouterr().err
    log = read_log(bench / "out" / "logs" / "segments__given" / "rep_01.mcap")
    assert log.metadata["plant"] == "tanks" and log.metadata["period_s"] == "0.001" and "pump" not in log.metadata
    pump, level = log.columns["pump_v"], log.columns["level_v"]
    assert pump[-1] == pytest.approx(4.0) and pump[50] == pytest.approx(2.0, rel=0.05)
    assert level[0] == 0.0 and 0.0 < level[-1] < 1.0 and np.all(np.diff(level) >= 0.0)
    # the water that came in is in the tanks or has run out
    assert level[-1] < 0.5 * np.sum(pump) * 0.001
    assert (bench / "out" / "report.html").is_file()


def test_a_carriage_follows_in_metres_under_the_users_own_law(bench: Path) -> None:
    config = made("plant=axis", "controller=lead", "trajectory=cycloid", "trajectory.amplitude_m=0.1", "parameters.coulomb=12")
    columns, _ = plant_simulation.run_test(config, 1)
    reference, position = columns["reference_position_m"], columns["position_m"]
    assert reference[-1] == pytest.approx(0.1)
    assert np.max(np.abs(reference - position)) < 0.02 and position[-1] > 0.08
    assert plant_simulation.prepare(config, 1).simulator.vector({"coulomb": 12.0}) == pytest.approx(
        plant_simulation.prepare(config, 1).p
    )
    again, _ = plant_simulation.run_test(config, 1)
    assert all(np.array_equal(columns[name], again[name]) for name in columns)
    other, _ = plant_simulation.run_test(
        made("plant=axis", "controller=lead", "trajectory=cycloid", "trajectory.amplitude_m=0.1"), 1
    )
    assert not np.array_equal(other["position_m"], position)


def test_a_size_in_the_plants_unit_takes_the_place_of_one_that_is_0_deg(bench: Path) -> None:
    columns, _ = plant_simulation.run_test(made("plant=tanks", "trajectory=hold", "trajectory.angle_v=2"), 1)
    assert set(columns["pump_v"][columns["phase"] == 3.0]) == {2.0}


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["plant=axiss"], "unknown plant 'axiss'; did you mean 'axis'"),
        (["plant=axis", "controller=pid"], "controller pid does not fit plant axis: it reads 'arm'"),
        (["plant=axis", "controller=pva"], "does not fit plant axis"),
        (["plant=tanks", "controller=lead"], "does not fit plant tanks: it reads 'position'"),
        (
            ["plant=axis", "parameters.coulom=3"],
            "unknown parameter 'coulom' in parameters of plant axis; did you mean 'coulomb'",
        ),
        (["plant=axis", "parameters.coulomb=-3"], "parameters.coulomb is -3; a number from 0.1 to 200 N is needed"),
        (["plant=axis", "start.velocit=1"], "unknown state 'velocit' in start of plant axis"),
        (["plant=axis", "effects.leakage.conductance=1"], "leakage"),
        (["plant=axis", "pump=pump1"], "plant axis: it has no group 'pump', which belongs to pump_joint"),
        (["plant=axis", "trajectory=ramp_pos"], "this plant's trajectory is in v; write amplitude_v=VALUE"),
        (["plant=axis", "backend=nidaqmx"], "backend 'nidaqmx' has no wiring of it"),
        (["plant=valve_joint", "controller=given", "trajectory=hold"], "it commands one input, the plant has 4"),
        (["controller=given"], "controller given does not fit plant pump_joint"),
    ],
)
def test_what_does_not_fit_is_refused_with_its_reason(bench: Path, lines: list[str], words: str) -> None:
    with pytest.raises(UsageError) as refused:
        made(*lines)
    assert words in str(refused.value)


def test_an_effect_acts_by_the_name_it_has_there(bench: Path) -> None:
    config = made("plant=axis", "trajectory=hold", "trajectory.angle_v=2", "effects.constant_force.strength=20")
    prepared = plant_simulation.prepare(config, 1)
    assert [effect.name for effect in prepared.simulator.composition.effects] == ["constant_force"]
    known = dict(zip(prepared.simulator.composition.parameters, prepared.p, strict=True))
    assert known["constant_force.strength"] == 20.0


def test_the_pump_joint_has_the_configuration_it_had(composer: Composer) -> None:
    config = composer.compose([]).config
    assert not {"plant", "parameters", "start"} & set(config)
    assert composer.compose(["plant=pump_joint"]).config == config


def test_a_saved_model_runs_with_its_late_inputs_and_the_bounds_of_its_logs(bench: Path) -> None:
    steps = ["trajectory=segments", "trajectory.segments=[{to_v: 4, in: 0.1, law: linear}, {rest: 0.4}]"]
    quiet = ["plant=tanks", *steps, "plant.scatter=0", "plant.noise=0", "parameters.k4=0.5"]
    on_time, _ = plant_simulation.run_test(made(*quiet), 1)
    (bench / "conf" / "model").mkdir()
    late = "name: late\nplant: tanks\nperiod_s: 4.0\nparameters: {delay.pump: 0.1505}\n"
    (bench / "conf" / "model" / "late.yaml").write_text(late + "effects: {command_delay: {delay: 90.0}}\n")
    config = made(*quiet, "model=late")
    assert config["model"]["effects"]["command_delay"]["delay"] == 90.0
    config["model"]["effects"] = {}
    found, _ = plant_simulation.run_test(config, 1)
    # the log says what was asked for; the water comes 150.5 samples after it
    assert np.array_equal(found["pump_v"], on_time["pump_v"])
    level = on_time["level_v"]
    assert found["level_v"][150] == 0.0 and level[-1] > 1e-4
    assert np.allclose(found["level_v"][151:], 0.5 * (level[1:-150] + level[:-151]), rtol=1e-3, atol=1e-7)
    same, _ = plant_simulation.run_test(made(*quiet, "parameters.delay.pump=0.1505"), 1)
    assert np.array_equal(same["level_v"], found["level_v"])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("plant: axis\n", "model 'other' is of plant 'axis'; this test is of plant tanks"),
        ("plant: tanks\nperiod_s: soon\n", "model.period_s is 'soon'; a number from 1e-06 to 1e+06 or null is needed"),
        ("plant: tanks\nparameters: {delay.pumps: 1.0}\n", "unknown input 'pumps'"),
        ("plant: tanks\nparameters: {delay.pump: soon}\n", "a delay in seconds is needed"),
    ],
)
def test_a_saved_model_that_cannot_be_run_is_refused(bench: Path, text: str, words: str) -> None:
    (bench / "conf" / "model").mkdir()
    base = "" if "parameters" in text else "parameters: {}\n"
    (bench / "conf" / "model" / "other.yaml").write_text(f"name: other\n{text}{base}effects: {{}}\n")
    with pytest.raises(UsageError) as refused:
        made("plant=tanks", "model=other")
    assert words in str(refused.value)


def test_a_model_of_another_plant_is_refused_by_the_pump_joint(bench: Path) -> None:
    (bench / "conf" / "model").mkdir()
    (bench / "conf" / "model" / "other.yaml").write_text("name: other\nplant: axis\nparameters: {}\neffects: {}\n")
    with pytest.raises(UsageError, match="is of plant 'axis'; this test is of plant pump_joint"):
        made("model=other")


SWING = '''"""A pendulum that swings freely."""
from hjcamp.plant import Measured, Parameter, Plant, State, body, contact, outside, sensor


class Swing(Plant):
    """A pendulum on a bearing with viscous friction."""

    angle = State("rad", typical=0.3)
    speed = State("rad/s", typical=2.0)
    inertia = Parameter("kg*m^2", 1e-4)
    weight = Parameter("N*m", 1e-2, (1e-4, 1.0), "log-uniform", base=True)
    viscous = Parameter("N*m*s", 2e-5, (1e-8, 1e-2), "log-uniform", base=True)
    angle_deg = Measured("encoder", of="angle")

    @staticmethod
    def equations(state, parameter, drive, rate):
        load = outside("N*m")
        pull = -parameter.weight * state.angle
        rub = contact(state.speed, push=pull + load, viscous=parameter.viscous)
        rate.angle = state.speed
        rate.speed = body(pull + load - rub, mass=parameter.inertia, load=load, position=state.angle)
        encoder = sensor(state.angle)
'''


def test_a_plant_without_inputs_moves_by_itself(bench: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (bench / "plants" / "swing.py").write_text(SWING)
    columns, _ = plant_simulation.run_test(made("plant=swing", "trajectory=hold", "start.angle=0.5"), 1)
    time, angle = columns["time_s"], np.radians(columns["angle_deg"])
    # a damped oscillation: decay b / 2 J, frequency sqrt(m g l / J - decay^2)
    decay = 2e-5 / 2e-4
    turn = np.sqrt(1e-2 / 1e-4 - decay**2)
    inside = (time >= 0.0) & (columns["phase"] == schedule.CONTROL)
    since = time - time[0]
    expected = 0.5 * np.exp(-decay * since) * (np.cos(turn * since) + decay / turn * np.sin(turn * since))
    np.testing.assert_allclose(angle[inside], expected[inside], atol=2e-5)
    assert cli.run(["run", "plant=swing", "controller=plain_pid", "trajectory=hold"]) == 2
    assert "controller plain_pid does not fit plant swing: the plant has no input" in capsys.readouterr().err
