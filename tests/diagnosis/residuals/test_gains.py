"""What a store gains where a piston that sticks and slips displaces it, and a coarse counter alone tells where the piston is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.residuals.balances import Balances
from hjcamp.diagnosis.residuals.gains import EVERY, Gains
from hjcamp.diagnosis.residuals.initial_states import smoothed_over
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.diagnosis.residuals.simulated import Predicted
from hjcamp.diagnosis.residuals.weak_form import ORDERS, RISE, slides
from hjcamp.model.declare.candidate import Candidate
from hjcamp.records.log import TestLog

WIDTH, PERIOD = 60, 0.002
AREA, STIFFNESS, STEP, NOISE = 1e-4, 1e11, 4e-4, 400.0
PRESS = '''"""A piston that rubs, and the line that it fills."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor, store


class Press(Plant):
    """A force moves a piston; a pump and the piston fill a line."""

    pressure = State("Pa", typical=1e5)
    position = State("m", typical=0.01)
    velocity = State("m/s", typical=0.1)
    pull = Input("N", typical=3.0)
    flow = Input("m^3/s", typical=1e-6)
    mass = Parameter("kg", 2.0)
    coulomb = Parameter("N", 1.0, (0.0, 10.0), base=True)
    area = Parameter("m^2", 1e-4)
    stiffness = Parameter("Pa/m^3", 1e11, (1e9, 1e13), base=True)
    drag = Parameter("m^2*s/m", 0.0)
    leap = Parameter("m^3/s", 0.0)
    period = 0.002
    position_m = Measured("scale", of="position", counts=4e-4)
    pressure_pa = Measured("gauge", of="pressure", noise=400.0)

    @staticmethod
    def equations(state, parameter, drive, rate):
        force = actuator(drive.pull)
        load = outside("N")
        friction = contact(state.velocity, push=force + load, coulomb=parameter.coulomb, mass=parameter.mass)
        rate.position = state.velocity
        rate.velocity = body(force + load - friction, mass=parameter.mass, load=load, position=state.position)
        side = 1.0 if state.velocity > 0.0 else (-1.0 if state.velocity < 0.0 else 0.0)
        spilled = parameter.drag * state.velocity * abs(state.velocity) + parameter.leap * side
        rate.pressure = store(drive.flow - parameter.area * state.velocity - spilled, stiffness=parameter.stiffness, name="line")
        scale = sensor(state.position)
        gauge = sensor(state.pressure)
'''


@pytest.fixture(autouse=True)
def press(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "press.py").write_text(PRESS)


def slipping(seed: int) -> tuple[Measured, np.ndarray]:
    """A piston that creeps, rests and slips within a few samples, counted coarsely; with its true states (n, states)."""
    chance, count = np.random.default_rng(seed), 6000
    speeds = np.zeros(count)
    for begin in np.sort(chance.integers(0, count - 40, 60)):
        length = int(chance.choice([8, 30]))
        slip = np.sin(np.pi * (np.arange(length) + 0.5) / length) ** 2
        speeds[begin : begin + length] += chance.uniform(-0.3, 0.3) * slip
    speeds += 2e-3 * np.sin(2 * np.pi * np.arange(count) / 1500.0)
    places = np.concatenate([[0.0], np.cumsum(0.5 * PERIOD * (speeds[1:] + speeds[:-1]))])
    flow = AREA * 0.02 * np.cos(2 * np.pi * np.arange(count) / 400.0)
    filled = np.concatenate([[0.0], np.cumsum(flow[:-1]) * PERIOD]) - AREA * places
    pressure = STIFFNESS * filled
    counted = np.round(places / STEP) * STEP
    gauge = pressure + NOISE * chance.standard_normal(count)
    columns = {
        "time_s": np.arange(count) * PERIOD, "position_m": counted, "pressure_pa": gauge, "pull_n": np.ones(count),
        "flow_m3s": flow,
    }  # fmt: skip
    from hjcamp.known_plants import plant_called
    from hjcamp.model.language.field_unit import field_of

    plant = plant_called("press", "here")
    columns[field_of("flow", "m^3/s", "press")] = columns.pop("flow_m3s")
    columns[field_of("pull", "N", "press")] = columns.pop("pull_n")
    measured = measured_tests([TestLog(columns, {"plant": "press", "period_s": str(PERIOD), "condition": "a"})], plant=plant)
    [test] = measured.tests
    first = round(test.time[0] / PERIOD)
    return measured, np.column_stack([pressure, places, speeds])[first : first + test.samples]


def balances_of(measured: Measured, states: np.ndarray) -> Balances:
    """The balances about a path (n, states)."""
    layout, base = Layout(measured, WIDTH), base_of(measured)
    n = len(layout.of_test) * WIDTH
    ends = states[np.minimum(np.arange(WIDTH, n + 1, WIDTH), len(states) - 1)]
    predicted = Predicted(states[:n, [1, 0]], states[:n], ends, 1.0, ends[:, :0])
    found = Balances.of(layout, Kernels(measured.plant, {}), base, predicted, np.arange(len(layout.of_test)) // 6)
    assert found is not None
    return found


def base_of(measured: Measured, **values: float) -> Candidate:
    return Candidate({name: measured.plant.parameters[name].default for name in measured.plant.base_parameters} | values, {})


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("predicted", ["the path", "rest"])
def test_a_true_store_is_balanced_to_its_noise_whatever_the_model_makes_of_the_slips(seed: int, predicted: str) -> None:
    measured, states = slipping(seed)
    found = balances_of(measured, states if predicted == "the path" else states * [1.0, 0.0, 0.0])
    [store] = [one for one in found.balanced if one.name == "pressure"]
    raw = found._raw(base_of(measured), found.states)[:, : store.features] / found.scale[: store.features]
    assert np.sqrt(np.mean(raw**2)) == pytest.approx(1.0, abs=0.2)


def test_a_displaced_volume_of_a_wrong_stiffness_is_in_the_balance() -> None:
    measured, states = slipping(7)
    found = balances_of(measured, states)
    less, true = (found.features(base_of(measured, stiffness=k * STIFFNESS))[:, 0] for k in (0.5, 1.0))
    assert np.mean(less**2) > 10.0 * np.mean(true**2)


def test_a_rate_that_bends_with_the_speed_has_no_slope_and_one_that_does_not_has_its_own() -> None:
    measured, states = slipping(1)
    layout = Layout(measured, WIDTH)
    states = states[: len(layout.of_test) * WIDTH]
    gains = Gains(layout, Kernels(measured.plant, {}), np.sign(states[:, 2:]))
    [slope] = gains.rated(base_of(measured), states).slopes
    assert slope[:, 0] == pytest.approx(-STIFFNESS * AREA)
    # what leaps, or bends most, where v passes 0 has no slope there
    [slope] = gains.rated(base_of(measured, area=0.0, drag=1.0), states).slopes
    fast = np.abs(states[:, 2]) > 0.01
    own = np.arange(len(states)) % EVERY == EVERY // 2
    assert slope[fast & own, 0] == pytest.approx(-2.0 * STIFFNESS * np.abs(states[fast & own, 2]), rel=0.01)
    resting = states * [1.0, 1.0, 0.0]
    for values in ({"drag": 1.0}, {"leap": 1e-6}):
        [slope] = gains.rated(base_of(measured, area=0.0, **values), resting).slopes
        assert np.all(slope[:, 0] == 0.0)


def test_noise_that_two_stores_share_is_taken_apart_and_that_of_one_is_left_alone() -> None:
    measured, states = slipping(2)
    found = balances_of(measured, states)
    assert np.array_equal(found.apart, np.eye(len(found.scale)))
    found.balanced = tuple(replace(found.balanced[0], whole=True) for _ in range(2))
    chance = np.random.default_rng(3)
    shared, own = chance.standard_normal((2, 12, 200, 2 * (ORDERS + 1)))
    shared[:, :, ORDERS + 1 :] = -shared[:, :, : ORDERS + 1]
    noise = 0.95 * shared + 0.3 * own
    apart = noise @ found._independent(noise)
    correlation = np.corrcoef(apart.reshape(-1, 2 * (ORDERS + 1)).T)
    assert correlation == pytest.approx(np.eye(2 * (ORDERS + 1)), abs=0.05)
    # whatever the order of the two stores
    order = np.roll(np.arange(2 * (ORDERS + 1)), ORDERS + 1)
    assert noise[:, :, order] @ found._independent(noise[:, :, order]) == pytest.approx(apart[:, :, order])


@pytest.mark.parametrize("smoothed", [0, 3, 12])
def test_a_contact_slides_where_no_rest_is_within_what_smooths_its_speed(smoothed: int) -> None:
    side = np.repeat([0.0, 1.0, -1.0, 0.0], [50, 80, 90, 40])
    found, reach = slides(side, smoothed), RISE + smoothed
    at = np.arange(len(side))
    # a step from one sample to the next lies within both
    assert np.array_equal(found, ((at >= 50 + reach) & (at < 129 - reach)) | ((at >= 130 + reach) & (at < 219 - reach)))
    measured, _ = slipping(1)
    assert smoothed_over(measured)["velocity"] > 0


def test_a_model_that_diverges_has_balances_that_are_no_numbers_and_no_warning() -> None:
    measured, states = slipping(5)
    found = balances_of(measured, states)
    for value in (np.nan, np.inf):
        found.states[100, 0] = value
        assert not np.isfinite(found.features(base_of(measured))).all()
