"""The menu of tests of any plant: motions of equal speeds both ways, within what was visited; courses of inputs in range."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from carriage import PERIOD, measured_log

from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.design.menu import _changed, menu
from hjcamp.diagnosis.design.truth import _state_at
from hjcamp.diagnosis.design.wanted import Wanted
from hjcamp.records.log import TestLog

SAMPLES = 3000


@cache
def swing(condition: str, seed: int) -> TestLog:
    return measured_log(seconds=7.0, seed=seed, condition=condition)


@pytest.fixture
def measured(axis: Path) -> Measured:
    return measured_tests([swing("swing", 1), swing("other", 2)])


def named(tests: list[Wanted]) -> dict[str, Wanted]:
    found = {one.name: one for one in tests}
    assert len(found) == len(tests) and all(one.samples == SAMPLES for one in tests)
    return found


def test_equal_speeds_are_equal_and_stay_where_the_logs_were(measured: Measured) -> None:
    tests = named(menu(measured, SAMPLES, by_motion=True))
    visited = np.concatenate([one.readings[:, 0] for one in measured.tests])
    for name in ("equal_speeds_slow", "equal_speeds_speed", "equal_speeds_fast"):
        path, speed = tests[name].readings[:, 0], tests[name].changes["speed"]
        assert visited.min() <= path.min() and path.max() <= visited.max()
        rate = np.diff(path) / PERIOD
        steady = rate[np.abs(np.abs(rate) / speed - 1.0) < 1e-6]
        assert len(steady) > 0.2 * SAMPLES
        assert set(np.sign(steady)) == {1.0, -1.0} or name == "equal_speeds_slow"


def test_a_measured_test_is_made_slower_smaller_and_the_other_way_round(measured: Measured) -> None:
    tests = named(menu(measured, SAMPLES, by_motion=True))
    again = tests["swing_again"].readings[:, 0]
    assert np.array_equal(again, measured.tests[0].readings[:SAMPLES, 0])
    slower = tests["swing_slower"].readings[:, 0]
    assert np.allclose(slower[::2], again[: SAMPLES // 2])
    assert np.ptp(tests["swing_half"].readings) == pytest.approx(0.5 * np.ptp(again))
    mirrored = tests["swing_mirrored"].readings[:, 0]
    assert np.allclose(mirrored - mirrored.mean(), again.mean() - again)


def test_courses_of_an_input_stay_in_its_range(measured: Measured) -> None:
    tests = named(menu(measured, SAMPLES, by_motion=False))
    volts = np.concatenate([one.inputs[:, 0] for one in measured.tests])
    courses = [one for one in tests.values() if one.driven]
    assert {one.name for one in courses} >= {"voltage_hold", "voltage_at_50", "voltage_steps", "voltage_up_and_down"}
    # what rests in every log (what friction scatters by) rests in every test
    assert all(np.all(one.inputs[:, 1] == 1.0) for one in tests.values())
    for one in courses:
        assert volts.min() - 1e-9 <= one.inputs[:, 0].min() and one.inputs[:, 0].max() <= volts.max() + 1e-9
        assert sum(seconds for _, seconds in one.pieces) == pytest.approx(SAMPLES * PERIOD)
        assert one.inputs[0, 0] == one.pieces[0][0] and one.inputs[-1, 0] == one.pieces[-1][0]


def test_a_test_that_nothing_drives_is_proposed_as_it_was_alone(measured: Measured) -> None:
    at_rest = tuple(replace(one, inputs=np.zeros_like(one.inputs)) for one in measured.tests)
    names = [one.name for one in _changed(replace(measured, tests=at_rest), 0, SAMPLES, by_motion=True)]
    assert names == ["swing_again"] and len(list(_changed(measured, 0, SAMPLES, by_motion=True))) > 3


def test_what_nothing_drives_may_begin_elsewhere(measured: Measured) -> None:
    at_rest = tuple(replace(one, inputs=np.zeros_like(one.inputs)) for one in measured.tests)
    tests = named(list(_changed(replace(measured, tests=at_rest), 0, SAMPLES, by_motion=False)))
    assert {name: one.begun for name, one in tests.items()} == {
        "swing_again": 1.0,
        "swing_half": 0.5,
        "swing_other_side": -1.0,
        "swing_farther": 1.5,
    }
    assert tests["swing_farther"].cost > tests["swing_half"].cost == 1.0


@pytest.mark.parametrize(("begun", "expected"), [(1.0, 0.9), (0.5, 0.5), (-1.0, -0.7), (3.0, 2.5), (-3.0, -1.5)])
def test_a_start_is_moved_about_where_the_test_ends(begun: float, expected: float) -> None:
    """A state decays from 0.9 to 0.1, and cannot fall below -1.5."""
    states = np.array([[0.9], [0.4], [0.4], [0.4], [0.4], [0.4], [0.1], [0.1]])
    layout = SimpleNamespace(of_test=np.array([0, 0]), width=4)
    analysis = SimpleNamespace(windows=SimpleNamespace(layout=layout, lowest=np.array([-1.5])))
    wanted = SimpleNamespace(of=0, start_at=0, begun=begun)
    assert _state_at(analysis, states, wanted)[0] == pytest.approx(expected)  # type: ignore[arg-type]
