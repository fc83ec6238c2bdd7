"""Balances at measured states: against closed forms, against plain Python, and in units of what the sensors' noise makes of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import slide as moved

from hjcamp.diagnosis.calibration.prediction_windows import predictable
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.estimation.likelihood import loss
from hjcamp.diagnosis.residuals.balances import Balances
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.diagnosis.residuals.simulated import Predicted
from hjcamp.diagnosis.residuals.weak_form import ORDERS
from hjcamp.diagnosis.validation.blocks import advantages, discrimination, ratio_t
from hjcamp.effects import load_effects
from hjcamp.known_plants import plant_called
from hjcamp.model.checks.place_checks import PlainModel
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.run.rates import Course, Rates

WIDTH = 30
CONTACT = '''"""A block that rubs on a rail."""

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor


class Block(Plant):
    """A force moves a block that rubs."""

    position = State("m", typical=0.1)
    velocity = State("m/s", typical=0.1)
    pull = Input("N", typical=3.0)
    mass = Parameter("kg", 2.0)
    coulomb = Parameter("N", 1.0, (0.0, 10.0), base=True)
    period = 0.005
    position_m = Measured("scale", of="position")

    @staticmethod
    def equations(state, parameter, drive, rate):
        force = actuator(drive.pull)
        load = outside("N")
        friction = contact(state.velocity, push=force + load, coulomb=parameter.coulomb, mass=parameter.mass)
        rate.position = state.velocity
        rate.velocity = body(force + load - friction, mass=parameter.mass, load=load, position=state.position)
        scale = sensor(state.position)
'''


def balances_of(measured: Measured, base: Candidate, effects: dict[str, type[Effect]] | None = None) -> Balances | None:
    """The balances over windows of `WIDTH` samples, each of six windows a block, about what the base predicts."""
    kernels = Kernels(measured.plant, effects or {})
    windows, _ = predictable(measured, kernels, base, [], WIDTH, "standard")
    assert windows.layout.width == WIDTH
    windows.move_starts(base)
    blocks = np.arange(len(windows.layout.of_test)) // 6
    return Balances.of(windows.layout, kernels, base, windows.predicted(base), blocks)


def about(measured: Measured, places: np.ndarray, speeds: np.ndarray, effects: dict[str, type[Effect]]) -> Balances:
    """The same about a path (n,) of places and speeds that is known."""
    layout, base = Layout(measured, WIDTH), of_base(measured)
    found = Balances.of(
        layout,
        Kernels(measured.plant, effects),
        base,
        path_of(layout, places, places, speeds),
        np.arange(len(layout.of_test)) // 6,
    )
    assert found is not None
    return found


def path_of(layout: Layout, shown: np.ndarray, places: np.ndarray, speeds: np.ndarray) -> Predicted:
    """A prediction that is a path (n,) as it is, shown as it is shown."""
    n, states = len(layout.of_test) * WIDTH, np.column_stack([places, speeds])
    ends = states[np.minimum(np.arange(WIDTH, n + 1, WIDTH), len(states) - 1)]
    return Predicted(shown[:n, None], states[:n], ends, 1.0, ends[:, :0])


def of_base(measured: Measured, **values: float) -> Candidate:
    return Candidate({name: measured.plant.parameters[name].default for name in measured.plant.base_parameters} | values, {})


def test_the_balance_of_the_true_model_is_the_sensors_noise(slab: Measured) -> None:
    found = balances_of(slab, of_base(slab, loss=2.5))
    assert found is not None
    features = found.features(of_base(slab, loss=2.5))
    assert features.shape == (len(found.layout.of_test), ORDERS + 1)
    assert np.sqrt(np.mean(features**2, axis=0)) == pytest.approx(np.ones(ORDERS + 1), abs=0.2)


def test_a_loss_that_the_model_lacks_is_in_the_balance_as_large_as_it_is(slab: Measured) -> None:
    true, less = of_base(slab, loss=2.5), of_base(slab, loss=2.0)
    found = balances_of(slab, true)
    assert found is not None
    change = (found.features(less) - found.features(true)) * found.scale
    # what is lost more over a window: 0.5 W/K of the measured warmth over 200 J/K, through the same test functions
    warmth = found.states[:, 0]
    lost = np.append(0.5 * (warmth[1:] + warmth[:-1]), 0.0) * 0.5 / 200.0
    by_hand = np.einsum("wt,wtj->wj", -lost.reshape(-1, WIDTH), found._tests["warmth"])
    assert change[:, :ORDERS] == pytest.approx(by_hand, abs=1e-9 * np.abs(by_hand).max())


def test_what_is_small_and_lasts_shows_more_over_a_block_than_over_a_window(slab: Measured) -> None:
    found = balances_of(slab, of_base(slab, loss=2.5))
    assert found is not None
    off = found.features(of_base(slab, loss=2.4)) - found.features(of_base(slab, loss=2.5))
    window, block = np.sqrt(np.mean(off[:, :ORDERS] ** 2, axis=0)).max(), np.sqrt(np.mean(off[:, ORDERS] ** 2))
    assert block > 1.5 * window


@pytest.fixture
def block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "block.py").write_text(CONTACT)
    return tmp_path


def rubbing(seed: int, noise: float, spring: float = 4.0) -> tuple[Measured, np.ndarray, np.ndarray]:
    """Pulls against 1 N of friction, by steps of 0.1 ms: the block rests, slides and turns; with its places (n,) and speeds (n,)."""
    from hjcamp.records.log import TestLog

    chance, count, fine = np.random.default_rng(seed), 2400, 50
    pulls = np.round(np.repeat(chance.uniform(-3.0, 3.0, count // 80), 80), 3)
    x = v = 0.0
    places, speeds = np.empty(count), np.empty(count)
    for k in range(count):
        places[k], speeds[k] = x, v
        for _ in range(fine):
            if v == 0.0 and abs(pulls[k]) <= 1.0:
                continue
            side = np.sign(v) or np.sign(pulls[k])
            later = v + 1e-4 * (pulls[k] - side - spring * x) / 2.0
            v = 0.0 if v * later < 0.0 else later
            x += 1e-4 * v
    shown = places + noise * chance.standard_normal(count)
    columns = {"time_s": np.arange(count) * 0.005, "position_m": shown, "pull_n": pulls}
    measured = measured_tests([TestLog(columns, {"plant": "block", "period_s": "0.005", "condition": "a"})])
    [test] = measured.tests
    first = round(test.time[0] / 0.005)
    return measured, places[first : first + test.samples], speeds[first : first + test.samples]


def test_a_contact_is_balanced_only_while_it_slides_one_way(block: Path) -> None:
    measured, _, _ = rubbing(1, 2e-5)
    found = balances_of(measured, of_base(measured))
    assert found is not None
    assert [(one.name, one.whole) for one in found.balanced] == [("velocity", False)]
    used = np.abs(found._tests["velocity"]).sum(axis=2).ravel() > 0.0
    side = found.moving[:, 0]
    assert used.any() and not used.all()
    assert np.all(side[used] != 0.0)
    # a spring of 4 N/m that the model lacks: the force that its balance misses is that of the spring
    rows = found._tests["velocity"][:, :, 0]
    missing = (found.features(of_base(measured)) * found.scale)[:, 0]
    spring = np.einsum("wt,wt->w", -4.0 * found.states[:, 0].reshape(-1, WIDTH) / 2.0 * 0.005, rows)
    seen = np.abs(rows).sum(axis=1) > 0.0
    assert np.corrcoef(missing[seen], spring[seen])[0, 1] > 0.99
    # a part of it is where the next window begins, which smoothing brings into this one
    assert np.polyfit(spring[seen], missing[seen], 1)[0] == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(("name", "key", "size"), [("sensor_gain", "gain", 0.5), ("sensor_lag", "lag", 0.05)])
def test_what_a_sensor_errs_by_is_taken_off_with_a_memory_or_without(block: Path, name: str, key: str, size: float) -> None:
    measured, places, speeds = rubbing(4, 2e-5, spring=0.0)
    shown = (1.0 + size) * places if name == "sensor_gain" else lagging(places, size)
    [test] = measured.tests
    measured = measured.with_tests([replace(test, readings=test.readings + (shown - places)[:, None])])
    effects = {one: effect for one, effect in load_effects(plant=measured.plant).items() if one == name}
    found, base = about(measured, places, speeds, effects), of_base(measured)
    [amplitude] = [one for one in effects[name].parameters if one == key or effects[name].parameters[one].off is not None]
    candidate = base.with_effect(name, {**effects[name].defaults(), amplitude: size})
    predicted = path_of(found.layout, shown, places, speeds)
    used = np.abs(found._tests["velocity"]).sum(axis=(1, 2)) > 0.0
    less, plain = (np.median(np.abs(one[used])) for one in (found.features(candidate, predicted), found.features(base)))
    assert less < 1.0 and less < 0.6 * plain


def lagging(values: np.ndarray, lag: float) -> np.ndarray:
    """What a sensor of first order shows of values at 5 ms, by steps of 0.05 ms between straight lines."""
    fine = np.interp(np.arange(len(values) * 100) / 100.0, np.arange(len(values)), values)
    shown = np.empty_like(fine)
    y = fine[0]
    for k, one in enumerate(fine):
        shown[k] = y
        y += (one - y) * 5e-5 / lag
    return shown[::100]


def test_what_smoothed_readings_make_of_a_balance_is_taken_off(block: Path) -> None:
    measured, places, speeds = rubbing(3, 1e-3, spring=0.0)
    found, base = about(measured, places, speeds, {}), of_base(measured)
    used = np.abs(found._tests["velocity"]).sum(axis=(1, 2)) > 0.0
    plain, less = (np.median(np.abs(one[used])) for one in (found._raw(base, found.states) / found.scale, found.features(base)))
    assert less < 0.7 * plain and less < 1.0


def test_a_state_whose_rate_depends_on_what_nothing_measures_has_no_balance(tanks: Path) -> None:
    from gauge import measured_log

    measured = measured_tests([measured_log()])
    assert balances_of(measured, of_base(measured)) is None


def test_rates_along_given_states_are_those_of_the_equations(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plants").mkdir()
    Path("plants/slide.py").write_text(moved.PLANT)
    plant = plant_called("slide", "here")
    chance, n = np.random.default_rng(2), 40
    states, inputs = chance.standard_normal((n, 2)), np.column_stack([chance.standard_normal(n), np.ones(n)])
    composition = Composition(plant)
    order = [plant.sampled_inputs().index(name) for name in ("voltage", "friction_scatter")]
    given = np.empty_like(inputs)
    given[:, order] = inputs
    p = np.array([item.default for item in composition.parameters.values()])
    begins = np.zeros(n, dtype=np.int64)
    begins[0] = 1
    along = Rates(composition).along(p, Course(0.005, begins, np.arange(n) * 0.005, np.zeros(n), states, given))
    plain = PlainModel(plant)
    for k in range(n - 1):
        now = plain.rates({"position": states[k, 0], "velocity": states[k, 1], "voltage": inputs[k, 0]})
        then = plain.rates({"position": states[k + 1, 0], "velocity": states[k + 1, 1], "voltage": inputs[k, 0]})
        assert along.before[k] == pytest.approx(list(now.values()), rel=1e-12)
        assert along.after[k] == pytest.approx(list(then.values()), rel=1e-12)


def test_what_two_kinds_say_twice_counts_once_where_blocks_decide() -> None:
    # the second kind is what the first says, in other units: losses add up, Student's t over blocks stays what it is
    blocks, turned, ratios = np.repeat(np.arange(12), 20), np.array([[2.0, 1.0], [0.5, 3.0]]), []
    for seed in range(20):
        chance = np.random.default_rng(seed)
        after = 20.0 * chance.standard_normal((240, 2))
        before = after + 8.0 * chance.standard_normal((240, 2))
        both = [np.hstack([one, one @ turned]) for one in (after, before)]
        assert loss(both[1]) - loss(both[0]) > 1.5 * (loss(before) - loss(after))
        alone = ratio_t(advantages(after, before, blocks), discrimination(after, before, blocks))
        twice = ratio_t(advantages(*both, blocks), discrimination(*both, blocks))
        ratios.append(twice[0] / alone[0])
    # twice the information would be a factor of 1.41
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.1)
