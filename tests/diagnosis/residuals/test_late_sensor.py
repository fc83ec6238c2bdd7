"""Windows of a late sensor: what it has caught up with goes on from window to window, and tells nothing of where the plant begins."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import cont2discrete

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.estimation.likelihood import loss
from hjcamp.diagnosis.residuals.continuity import Memory, Passage
from hjcamp.effects import load_effects
from hjcamp.records.log import TestLog

CAPACITY, LOSS, CATCHING_UP = 280.0, 0.55, 18.0
BLOCK = '''"""A heated block."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, path, sensor, store


class Block(Plant):
    """A block is heated, and cools to its room."""

    warmth = State("K", typical=20.0)
    power = Input("W", typical=30.0)
    capacity = Parameter("J/K", 250.0, (20.0, 5e3), "log-uniform", base=True)
    loss = Parameter("W/K", 0.5, (0.01, 10.0), "log-uniform", base=True)
    period = 2.0
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        command = actuator(drive.power)
        lost = path(parameter.loss * (state.warmth - 0.0), upstream=state.warmth, downstream=0.0)
        rate.warmth = store(command - lost, capacity=parameter.capacity)
        probe = sensor(state.warmth)
'''
MASS, DAMPING, STIFFNESS, LAG, PERIOD = 2.0, 20.0, 7e4, 4e-3, 1.0 / 750.0
PLANT = '''"""A mass on a mount."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, outside, sensor


class Mount(Plant):
    """An oscillator of one mass."""

    position = State("m", typical=1e-3)
    velocity = State("m/s", typical=0.1)
    force = Input("N", typical=50.0)
    mass = Parameter("kg", 2.3, (0.1, 100.0), "log-uniform", base=True)
    damping = Parameter("N*s/m", 24.0, (0.1, 1e3), "log-uniform", base=True)
    stiffness = Parameter("N/m", 6e4, (1e3, 1e6), "log-uniform", base=True)
    period = 1 / 750
    position_mm = Measured("laser", of="position")

    @staticmethod
    def equations(state, parameter, drive, rate):
        push = actuator(drive.force)
        load = outside("N")
        mount = parameter.damping * state.velocity + parameter.stiffness * state.position
        rate.position = state.velocity
        rate.velocity = body(push + load - mount, mass=parameter.mass, load=load, position=state.position)
        laser = sensor(state.position)
'''


@pytest.fixture
def mount(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    """The log of a mount whose sensor is late, solved exactly from sample to sample."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "mount.py").write_text(PLANT, encoding="utf-8")
    generator, count = np.random.default_rng(1), 2400
    force = np.repeat(generator.uniform(-50.0, 50.0, count // 10), 10)
    rates = np.array([[0.0, 1.0, 0.0], [-STIFFNESS / MASS, -DAMPING / MASS, 0.0], [1.0 / LAG, 0.0, -1.0 / LAG]])
    step, push, *_ = cont2discrete((rates, np.array([[0.0], [1.0 / MASS], [0.0]]), np.eye(3), np.zeros((3, 1))), PERIOD)
    state, shown = np.zeros(3), np.empty(count)
    for k in range(count):
        shown[k] = state[2]
        state = step @ state + push[:, 0] * force[k]
    columns = {
        "time_s": PERIOD * np.arange(count),
        "force_n": force,
        "position_mm": 1e3 * shown + 2e-3 * generator.standard_normal(count),
    }
    return measured_tests([TestLog(columns, {"plant": "mount", "period_s": str(PERIOD), "condition": "steps"})])


def test_one_turn_moves_the_starts_of_its_windows_to_where_they_belong(mount: Measured) -> None:
    library = load_effects(plant=mount.plant)
    analysis = calibrated(mount, {"sensor_lag": library["sensor_lag"]}, unknowns=False)
    true = {"mass": MASS, "damping": DAMPING, "stiffness": STIFFNESS, "delay.force": 0.0}
    late = analysis.base.fitted.candidate.with_base(true).with_effect("sensor_lag", {"lag": LAG, "dead_share": 0.0})
    windows = copy.copy(analysis.windows)
    windows.place = analysis.base.place
    left = [loss(windows.move_starts(late, rounds=1)) for _ in range(3)]
    assert left[0] == pytest.approx(left[2], rel=0.02)
    errors = windows.errors(late) / mount.noise
    assert np.sqrt(np.mean(errors**2)) < 1.2  # what is left is noise, from the first sample of each window on
    assert np.sqrt(np.mean(errors[:: windows.layout.width] ** 2)) < 1.3


@pytest.fixture
def block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    """The log of a block whose probe is far later than a sample, solved exactly from sample to sample."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "block.py").write_text(BLOCK, encoding="utf-8")
    generator, count = np.random.default_rng(5), 1500
    power = np.repeat(
        generator.choice([0.0, 0.0, 10.0, 25.0, 40.0, 60.0], count // 30) * generator.uniform(0.7, 1.3, count // 30), 30
    )
    rates = np.array([[-LOSS / CAPACITY, 0.0], [1.0 / CATCHING_UP, -1.0 / CATCHING_UP]])
    step, push, *_ = cont2discrete((rates, np.array([[1.0 / CAPACITY], [0.0]]), np.eye(2), np.zeros((2, 1))), 2.0)
    state, shown = np.zeros(2), np.empty(count)
    for k in range(count):
        shown[k] = state[1]
        state = step @ state + push[:, 0] * power[k]
    columns = {"time_s": 2.0 * np.arange(count), "power_w": power, "warmth_k": shown + 0.03 * generator.standard_normal(count)}
    return measured_tests([TestLog(columns, {"plant": "block", "period_s": "2.0", "condition": "steps"})])


def test_a_fit_of_a_late_sensor_ends_where_its_lag_is_however_far_it_begins(block: Measured) -> None:
    library = load_effects(plant=block.plant)
    analysis = calibrated(block, {name: library[name] for name in ("sensor_lag", "command_delay")}, unknowns=False)
    base, search = analysis.base.fitted.candidate, analysis.search
    late = [search.fitted(base.with_effect("sensor_lag", {"lag": lag, "dead_share": 0.0})) for lag in (5.0, 40.0)]
    for one in late:
        # a delay of the only input is hardly distinguishable from it
        late_by = one.fitted.candidate.effects["sensor_lag"]["lag"] + one.fitted.candidate.base["delay.power"]
        assert late_by == pytest.approx(CATCHING_UP, rel=0.02)
        assert one.fitted.candidate.base["capacity"] == pytest.approx(CAPACITY, rel=0.01)
        assert np.sqrt(np.mean(analysis.windows.layout.predictions(one.fitted.features) ** 2)) < 1.1  # noise
    # a lag of the drive says the same, and neither is named alone
    found = decided(analysis)
    assert (found.word, set(found.effects)) == ("one_of", {"sensor_lag", "command_delay"})


@pytest.mark.study
def test_the_lag_of_a_sensor_and_that_of_its_drive_are_one_on_a_linear_plant(mount: Measured) -> None:
    library = load_effects(plant=mount.plant)
    analysis = calibrated(mount, {name: library[name] for name in ("sensor_lag", "command_delay", "sensor_gain", "spring")})
    found = decided(analysis)
    assert (found.word, set(found.effects)) == ("one_of", {"sensor_lag", "command_delay"})


def test_a_start_is_told_beside_what_the_sensor_begins_with() -> None:
    # one state, one sensor's state; three readings of each of two windows
    readings = np.array([[[3.0], [2.0], [1.0]]] * 2)
    own = np.array([[[3.0], [0.0], [0.0]]] * 2)
    going_on = np.zeros((2, 1, 1))  # nothing of the window before is left of what is remembered
    memory = Memory(own, going_on, going_on, np.array([True]), np.array([False, False]))
    passage = Passage.of(readings, np.ones((2, 1, 1)), np.array([False]), np.array([False, True]), memory)
    # the first reading tells nothing of the start: whatever the sensor began with moves it
    left = np.einsum("wfs,ws->wf", readings, np.full((2, 1), 0.25)) + np.array([[7.0, 0.0, 0.0], [-5.0, 0.0, 0.0]])
    assert passage.begun(left, np.zeros((2, 1)), np.zeros((2, 1)))[0] == pytest.approx(0.25)
    # what it reads is an error where nothing before explains it, but for the start's own, which noise of 1 tells to 1 / sqrt(2² + 1²)
    kept = 1.0 / np.sqrt(1.0 + 3.0**2 / 5.0)
    assert passage.unexplained(left, np.zeros((2, 1)), np.zeros((2, 1)))[:, 0] == pytest.approx([7.75 * kept, -4.25 * kept])
    assert passage.less(left)[:, 0] == pytest.approx(0.0)


def test_what_the_noise_of_the_window_before_makes_of_a_reading_is_no_error_of_the_model() -> None:
    # a start that the second reading alone tells moves what is remembered by twice as much, half of which is left a window later
    readings, own = np.array([[[0.0], [2.0], [0.0]]] * 3), np.array([[[3.0], [0.0], [0.0]]] * 3)
    goes_on = np.array([False, True, True])
    memory = Memory(own, np.full((3, 1, 1), 2.0), np.full((3, 1, 1), 0.5), np.array([False]), ~goes_on)
    passage = Passage.of(readings, np.ones((3, 1, 1)), np.array([False]), goes_on, memory)
    left = np.full((3, 3), 7.0)
    found = passage.unexplained(left, np.zeros((3, 1)), np.zeros((3, 1)))
    # the first window tells what is remembered itself, by its first reading, to 1 / 3
    told = (2.0 / 2.0) ** 2 + (0.5 / 3.0) ** 2
    variances = np.array([told, (2.0 / 2.0) ** 2 + 0.25 * told])
    assert found[:, 0] == pytest.approx([0.0, *(7.0 / np.sqrt(1.0 + 9.0 * variances))])
    assert found[:, 1:] == pytest.approx(np.array([[0.0, 7.0]] * 3))


def test_what_a_diverging_model_remembers_is_no_noise() -> None:
    readings, own = np.array([[[0.0], [2.0], [0.0]]] * 4), np.array([[[3.0], [0.0], [0.0]]] * 4)
    goes_on = np.array([False, True, True, True])
    memory = Memory(own, np.full((4, 1, 1), 2.0), np.full((4, 1, 1), 1e150), np.array([False]), ~goes_on)
    passage = Passage.of(readings, np.ones((4, 1, 1)), np.array([False]), goes_on, memory)
    found = passage.unexplained(np.full((4, 3), 7.0), np.zeros((4, 1)), np.zeros((4, 1)))
    # noise that is larger than all hides what it makes, and one beyond all numbers hides nothing
    assert found[1] == pytest.approx([0.0, 0.0, 7.0], abs=1e-9) and found[3] == pytest.approx([7.0, 0.0, 7.0])
