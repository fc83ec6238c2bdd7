"""Two dry contacts in one plant: every combination of their regimes, against answers by hand and SciPy with events."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from plain_kernel import uncompiled
from two_contacts import FREE_PENDULUM, FREE_SPRING, FREE_STACK, PENDULUM, SPRING, STACK, Dry, pendulum, spring

from hjcamp import cli
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.checks.plant_checks import check_passive, check_pushes
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Course, Given
from hjcamp.model.declare.parameter import Cut
from hjcamp.model.language.vocabulary import read_vocabulary
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.model.run.simulator import Simulator

PLANTS = {
    "spring": SPRING,
    "pendulum": PENDULUM,
    "stack": STACK,
    "free_spring": FREE_SPRING,
    "free_pendulum": FREE_PENDULUM,
    "free_stack": FREE_STACK,
}


@pytest.fixture
def rig(folder: Path) -> Path:
    for name, text in PLANTS.items():
        (folder / "plants" / f"{name}.py").write_text(text)
    return folder


def free(name: str) -> Simulator:
    return uncompiled(Simulator(Composition(find_plant(name)), free=True))


def run(model: Simulator, start: list[float], period: float, force: np.ndarray, tolerance: float = 1.0) -> np.ndarray:
    """Return the states (n, states) of one test under one input."""
    plant = model.composition.plant
    begins = np.zeros(len(force), dtype=np.int64)
    begins[0] = 1
    given = inputs_along(plant, len(force), **{next(iter(plant.inputs)): force})
    time = np.arange(len(force)) * period
    return model.run_free(model.vector({}), Given(period, begins, time, given, np.array([start])), tolerance)[1]


def test_one_block_stops_where_the_spring_has_turned_its_push_and_the_other_never_moves(rig: Path) -> None:
    # m x'' = F - c - k x from rest: half a swing, to 2 (F - c) / k; it stays there as |F - k x| = |2 c - F| <= c
    model, pull = free("spring"), 11.0
    states = run(model, [0.0, 0.0, 0.0, 0.0], 1e-3, np.full(400, pull))
    time = np.arange(400) * 1e-3
    swing = np.sqrt(1e3 / 2.0)
    half = np.minimum(time, np.pi / swing)
    assert np.abs(states[:, 0] - (pull - 8.0) / 1e3 * (1.0 - np.cos(swing * half))).max() < 1e-7
    assert states[-1, 0] == pytest.approx(2.0 * (pull - 8.0) / 1e3, abs=1e-8) and states[-1, 1] == 0.0
    assert np.all(states[:, 2:] == 0.0)
    assert np.all(run(model, [0.0] * 4, 1e-3, np.full(50, 7.99)) == 0.0)


def test_the_second_block_breaks_away_at_its_own_static_friction(rig: Path) -> None:
    states = run(free("spring"), [0.0] * 4, 1e-3, np.linspace(0.0, 30.0, 1500))
    first = int(np.argmax(states[:, 3] != 0.0))
    force = 1e3 * (states[:, 0] - states[:, 2])
    assert np.abs(force[:first]).max() <= 7.0 < force[first - 1] + 2.0 * np.diff(force[: first + 1]).max()
    assert states[int(np.argmax(states[:, 1] != 0.0)), 0] < states[first, 0]


@pytest.mark.parametrize(
    ("name", "solve", "start", "period", "force"),
    [
        ("spring", spring, [0.0, 0.0, 0.0, 0.0], 4e-3, lambda t: 22.0 * np.sin(7.0 * t) * np.exp(-0.3 * t)),
        ("spring", spring, [0.01, 0.0, -0.005, 0.3], 4e-3, lambda t: 12.0 * np.sign(np.sin(9.0 * t))),
        ("free_spring", spring, [0.01, 0.0, -0.005, 0.3], 4e-3, lambda t: 12.0 * np.sign(np.sin(9.0 * t))),
        ("pendulum", pendulum, [0.0, 0.0, 0.9, 0.0], 4e-3, lambda t: 0.0 * t),
        ("free_pendulum", pendulum, [0.0, 0.0, 0.9, 0.0], 4e-3, lambda t: 0.0 * t),
        ("free_pendulum", pendulum, [0.0, 0.0, 0.02, 0.0], 4e-3, lambda t: 2.6 * np.sin(4.0 * t) * (t < 1.5)),
        ("pendulum", pendulum, [0.0, 0.0, 0.02, 0.0], 4e-3, lambda t: 2.6 * np.sin(4.0 * t) * (t < 1.5)),
    ],
)
def test_it_follows_an_independent_solution_with_events(
    rig: Path,
    name: str,
    solve: Callable[[np.ndarray], Dry],
    start: list[float],
    period: float,
    force: Callable[[np.ndarray], np.ndarray],
) -> None:
    time = np.arange(600) * period
    inputs = np.asarray(force(time))
    found = run(free(name), start, period, inputs)
    other = solve(np.array(start))
    other.sides = tuple(int(np.sign(start[k])) for k in other.at)  # type: ignore[assignment]
    expected = np.empty_like(found)
    for k, given in enumerate(inputs):
        expected[k] = other.z
        other.step(time[k], period, float(given))
    seen = {sides for _, sides in other.events}
    assert len(seen) >= 5 and {0} < {side for pair in seen for side in pair}
    # events are placed to 1/1024 of a sample: with samples four times finer the difference falls
    finer = run(free(name), start, period / 4, np.repeat(inputs, 4))[::4]
    size = np.ptp(expected, axis=0)
    assert (np.abs(found - expected).max(axis=0) / size).max() < 1e-3
    assert (np.abs(finer - expected).max(axis=0) / size).max() < 2e-4


@pytest.mark.parametrize("name", ["stack", "free_stack"])
@pytest.mark.parametrize(
    ("pull", "sledge", "block"),
    [(2.5, 0.0, 0.0), (4.5, 0.5, 0.5), (9.0, 1.0, 4.0), (-9.0, -1.0, -4.0)],
)
def test_a_block_on_a_sledge_rests_goes_along_or_slips(rig: Path, name: str, pull: float, sledge: float, block: float) -> None:
    # 3 N at the table, 5 N between: (4.5 - 3) / 3 kg together; above 6 N sledge (5 - 3) / 2 kg, block (9 - 5) / 1 kg
    states = run(free(name), [0.0, 0.0, 0.0], 1e-3, np.full(300, pull))
    speeds = states[-1, 0] - states[-101, 0], states[-1, 0] + states[-1, 1] - states[-101, 0] - states[-101, 1]
    assert np.array(speeds) / 0.1 == pytest.approx([sledge, block], abs=1e-9)


def course(model: Simulator, states: np.ndarray, period: float, force: np.ndarray) -> Course:
    """Return states as if all of them had been measured, restarted once in the middle."""
    composition = model.composition
    names = list(composition.states)
    restart = np.zeros(len(states), dtype=np.int64)
    restart[[0, len(states) // 2]] = 2, 1
    columns = {
        kind: states[:, [names.index(one) for one in found]]
        for kind, found in (
            ("driven", list(composition.cut.driven)),
            ("observed", list(composition.observed)),
            ("velocity", [one.velocity for one in composition.contacts]),
        )
    }
    given = inputs_along(composition.plant, len(states), pull=force)
    return Course(period, restart, np.arange(len(states)) * period, given=given, **columns)


def test_a_cut_drives_no_state_or_one_and_carries_the_inputs_as_recorded(rig: Path) -> None:
    plant, period = find_plant("spring"), 1e-3
    time = np.arange(900) * period
    force = 22.0 * np.sin(7.0 * time)
    states = run(free("spring"), [0.0] * 4, period, force)
    whole = uncompiled(Simulator(Composition(plant)))
    found = whole.follow(whole.vector({}), course(whole, states, period, force))
    assert np.array_equal(found.ideal[:450], states[:450, [0, 2]])
    assert np.abs(found.ideal - states[:, [0, 2]]).max() < 1e-9
    driven = Cut("first", driven={"x": "x_m"}, slopes={"v": "x"})
    follower = uncompiled(Simulator(Composition(plant, cut=driven)))
    assert follower.composition.free == (False, True)
    found = follower.follow(follower.vector({}), course(follower, states, period, force))
    assert np.array_equal(found.ideal[:, 0], states[:, 0])
    moved = np.ptp(states[:, 2])
    assert np.abs(found.ideal[:, 1] - states[:, 2]).max() < 1e-3 * moved and moved > 0.01


def test_the_regimes_of_contacts_and_limiters_are_one_product(rig: Path) -> None:
    composition = Composition(find_plant("spring"))
    kernel = free("spring").kernel
    for first in (-1.0, 0.0, 1.0):
        for second in (-1.0, 0.0, 1.0):
            code = composition.direction({"direction_first": first, "direction_second": second})
            assert (kernel.facing(code, 0), kernel.facing(code, 1)) == (first, second)
            assert kernel.faced(code, 1, 0.0) == composition.direction({"direction_first": first})
    assert read_vocabulary(find_plant("spring")).contacts[1].limit == "second_static"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("push=spring,", "push=spring * drive.direction,", "of which contact? Write drive.direction_first or"),
        ("push=spring,", "push=spring * drive.direction_secnd,", "did you mean 'second'"),
        ("second = contact(state.w", "second = contact(state.v", "two contacts have the velocity 'v'"),
    ],
)
def test_a_regime_belongs_to_a_contact(rig: Path, old: str, new: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = rig / "plants" / "spring.py"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    assert cli.run(["plants", "test", "spring"]) == 2
    assert told in capsys.readouterr().err


def test_inputs_are_known_by_name(rig: Path) -> None:
    with pytest.raises(UsageError, match="did you mean 'pull'"):
        inputs_along(find_plant("spring"), 3, pul=1.0)


def test_a_push_that_does_not_hold_is_refused_and_one_for_some_contacts_too(rig: Path) -> None:
    for name in PLANTS:
        assert check_pushes(find_plant(name))
    pushed = "push=along - swinging * between / inertia * swung, "
    for name, push in (("alone", "push=along, "), ("lacking", "")):
        (rig / "plants" / f"{name}.py").write_text(PENDULUM.replace(pushed, push))
    with pytest.raises(UsageError, match=r"push of contact 'rail' is .* would hold it, by the rates.*leave push= out"):
        check_pushes(find_plant("alone"))
    with pytest.raises(UsageError, match="contact 'rail' has no push and 'pivot' has one"):
        read_vocabulary(find_plant("lacking"))


@pytest.mark.parametrize(
    ("rate", "said"),
    [
        ("(spring - second)", "mass2"),
        ("(spring + 0.0 * second)", "does not reach rate.w: subtract it"),
        ("(spring + second)", "speeds up 'w': it is added to the force"),
        ("(spring - second * abs(second) / parameter.dry2)", "other than in proportion"),
    ],
)
def test_friction_without_a_push_has_to_brake_its_velocity_in_proportion(rig: Path, rate: str, said: str) -> None:
    (rig / "plants" / "other.py").write_text(FREE_SPRING.replace("(spring - second)", rate))
    if said == "mass2":
        assert check_passive(find_plant("other")) == "2 contacts"
        return
    with pytest.raises(UsageError, match=said):
        check_passive(find_plant("other"))
