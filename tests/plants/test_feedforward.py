"""The input that inverts a model: alone it makes the plant follow its reference; where that cannot be, the reason is said."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.backends import run_test
from hjcamp.commands.shared.plant_template import TEMPLATE
from hjcamp.configuration.check import check_configuration
from hjcamp.configuration.composer import Composer, free
from hjcamp.errors import UsageError

HEAD = "from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, sensor\n\n"
SLAB = (
    HEAD
    + '''
class Slab(Plant):
    """A block that loses heat the faster the warmer it is."""
    warmth = State("K", typical=20.0)
    power = Input("W", typical=50.0)
    capacity = Parameter("J/K", 200.0)
    loss = Parameter("W/K", 2.0, (0.01, 100.0), base=True)
    more = Parameter("W/K^2", 0.05, (0.0, 1.0))
    period = 1.0
    warmth_k = Measured("probe", of="warmth")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.warmth = (drive.power - parameter.loss * state.warmth - parameter.more * state.warmth**2) / parameter.capacity
        probe = sensor(state.warmth)
'''
)
LAGS = (
    HEAD
    + '''
class Lags(Plant):
    """Two blocks, of which one is measured."""
    near = State("K", typical=20.0)
    far = State("K", typical=20.0)
    power = Input("W", typical=50.0)
    rate_of_heat = Parameter("K/J", 0.01)
    exchange = Parameter("1/s", 0.05)
    period = 1.0
    near_k = Measured("probe", of="near")

    @staticmethod
    def equations(state, parameter, drive, rate):
        rate.near = parameter.rate_of_heat * drive.power - parameter.exchange * (state.near - state.far)
        rate.far = parameter.exchange * (state.near - state.far)
        probe = sensor(state.near)
'''
)
QUIET = ("plant.scatter=0", "plant.noise=0", "controller.kp=0")
AXIS = ("plant=axis", "controller=feedforward_pid", "trajectory=segments", *QUIET)
MOVES = "trajectory.segments=[{to_m: 0.1, in: 0.5}, {rest: 0.3}, {to_m: -0.05, in: 0.6}, {rest: 0.2}]"


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a user's folder with an axis, a block and two blocks."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    for name, text in (("axis", TEMPLATE.format(title="Axis")), ("slab", SLAB), ("lags", LAGS)):
        (tmp_path / "plants" / f"{name}.py").write_text(text)
    return tmp_path


def columns_of(*lines: str) -> dict[str, Any]:
    config = Composer().compose([free(line) for line in lines]).config
    check_configuration(config)
    return run_test(config, 1)[0]


def test_an_axis_follows_by_the_feedforward_alone(lab: Path) -> None:
    found = columns_of(*AXIS, MOVES)
    error = found["position_m"] - found["reference_position_m"]
    assert np.abs(error).max() < 1e-3 * np.ptp(found["reference_position_m"])
    # by hand in the middle of the first move: M a + F_c + F_v v over the gain
    k, h, wanted = int(np.flatnonzero(found["phase"] == 3.0)[0]) + 250, 1e-3, found["reference_position_m"]

    def by_hand(k: int) -> float:
        velocity, acceleration = (wanted[k + 1] - wanted[k - 1]) / (2 * h), np.diff(wanted[k - 1 : k + 2], 2)[0] / h**2
        return float((95.0 * acceleration + 20.0 + 200.0 * velocity) / 35.0)

    assert found["voltage_v"][k] == pytest.approx(0.5 * (by_hand(k) + by_hand(k + 1)), rel=1e-3)


@pytest.mark.parametrize(("gain", "off"), [(1.0, 1e-3), (0.0, 0.9)])
def test_a_block_with_a_curved_loss_follows(lab: Path, gain: float, off: float) -> None:
    lines = ("plant=slab", "controller=feedforward_pid", f"controller.gain={gain}", "trajectory=segments", *QUIET)
    found = columns_of(*lines, "trajectory.segments=[{to_k: 30, in: 200}, {rest: 100}, {to_k: 10, in: 200}]")
    error = found["warmth_k"] - found["reference_warmth_k"]
    share = np.abs(error).max() / np.ptp(found["reference_warmth_k"])
    assert share < off if gain else share > off


def test_an_identified_model_takes_what_the_declared_one_misses(lab: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (lab / "conf" / "model").mkdir(parents=True)
    (lab / "conf" / "model" / "with_spring.yaml").write_text(
        "name: with_spring\nplant: axis\nparameters: {mass: 110.0}\neffects: {spring: {stiffness: 2000.0}}\n"
    )
    errors = {}
    for model in ("published", "with_spring"):
        machine = ("effects.spring.stiffness=2000", "parameters.mass=110", f"controller.model={model}")
        words = ["run", *AXIS, MOVES, *machine, "repetitions=1", f"run_dir={model}"]
        assert cli.run(words) == 0, capsys.readouterr().err
        from hjcamp.records.read import read_log

        log = read_log(next(Path(model).rglob("*.mcap"))).columns
        errors[model] = np.abs(log["position_m"] - log["reference_position_m"]).max()
    assert errors["with_spring"] < 0.02 * errors["published"]


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        (("plant=lags", "controller=feedforward_pid", "trajectory=hold"), "acts on the first derivative of what is controlled"),
        ((*AXIS, MOVES, "controller.model=late"), "no value of it moves the plant as the reference asks"),
        ((*AXIS, MOVES, "controller.model=weak"), "has no influence at once"),
        ((*AXIS, MOVES, "controller.model=nowhere"), "nowhere"),
    ],
)
def test_what_cannot_be_inverted_is_refused_with_the_reason(
    lab: Path, lines: tuple[str, ...], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (lab / "conf" / "model").mkdir(parents=True)
    for name, effects in (("late", "{action_lag: {}}"), ("weak", "{saturation: {limit: 10.0}}")):
        (lab / "conf" / "model" / f"{name}.yaml").write_text(
            f"name: {name}\nplant: axis\nparameters: {{}}\neffects: {effects}\n"
        )
    assert cli.run(["plan", *lines]) == 2
    err = capsys.readouterr().err
    assert says in err and err.count("\n") == 1, err


def test_more_states_than_the_reference_determines(lab: Path) -> None:
    from hjcamp.model.run.inverse import MOST_STATES, Inverse

    text = LAGS.replace("class Lags", "class Three").replace(
        "power = Input", 'third = State("K", typical=1.0)\n    power = Input'
    )
    text = text.replace(
        "        probe =", "        rate.third = parameter.exchange * (state.far - state.third)\n        probe ="
    )
    (lab / "plants" / "three.py").write_text(text)
    from hjcamp.known_plants import find_plant
    from hjcamp.model.compile.compose import Composition

    with pytest.raises(UsageError, match=f"it has 3 states; .* determines {MOST_STATES} at most"):
        Inverse(Composition(find_plant("three"), ()), 0, "power", np.zeros(2))
