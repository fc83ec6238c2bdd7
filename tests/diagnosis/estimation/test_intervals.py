"""Intervals of fitted parameters: of straight lines as textbooks have them, and none where nothing tells a parameter."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free
from hjcamp.diagnosis.estimation.intervals import Interval, covariance_of, intervals
from hjcamp.model.declare.candidate import Candidate
from hjcamp.report.wording.units import told_interval

WINDOWS = 40
CHAPTERS = np.arange(WINDOWS) // 4


def fitted(columns: list[np.ndarray], high: float = 10.0, seed: int = 3) -> Fitted:
    """Return a fit of one feature a window, as large as its noise, with ten times these slopes, at 2 for each parameter."""
    names = [f"p{number}" for number in range(len(columns))]
    features = np.random.default_rng(seed).standard_normal((WINDOWS, 1))
    features -= np.stack(columns, axis=1) @ np.linalg.pinv(np.stack(columns, axis=1)) @ features
    free = tuple(Free("", name, 1.0, 0.0, high) for name in names)
    slopes = 10.0 * np.stack(columns, axis=1)[:, None, :]
    return Fitted(Candidate(dict.fromkeys(names, 2.0), {}), free, features, slopes, 0.0)


def by_name(found: Fitted) -> dict[str, Interval]:
    return {one.name: one for one in intervals(found, CHAPTERS)}


def test_a_slope_has_the_interval_of_a_straight_line() -> None:
    x = np.linspace(-1.0, 1.0, WINDOWS)
    found = [one for seed in range(60) for one in intervals(fitted([x], seed=seed), CHAPTERS)]
    # white noise of 0.1 about a line: sigma / sqrt(sum x^2), times Student's t of nine degrees of freedom
    wide = math.sqrt(np.mean([(one.high - one.low) ** 2 for one in found]))
    assert wide == pytest.approx(2 * 2.26 * 0.1 / math.sqrt(float(x @ x)), rel=0.15)
    assert all(one.told and one.row == {"ci95": [one.low, one.high]} for one in found)


def test_what_no_reading_depends_on_may_be_all_that_its_bounds_allow() -> None:
    x = np.linspace(-1.0, 1.0, WINDOWS)
    found = by_name(fitted([x, np.zeros(WINDOWS)]))
    assert found["p0"].told and found["p0"].high - found["p0"].low < 0.3
    assert not found["p1"].told and (found["p1"].low, found["p1"].high) == (0.0, 10.0)
    assert found["p1"].row == {"ci95": [0.0, 10.0], "told": False}
    assert told_interval({"unit": "1", **found["p1"].row}) == "not identifiable from these tests"


def test_two_that_only_act_together_are_not_told_either() -> None:
    x, y = np.linspace(-1.0, 1.0, WINDOWS), np.cos(np.arange(WINDOWS))
    found = by_name(fitted([x, -3.0 * x, y]))
    # p0 may be all that its bounds allow, and takes p1 along by a third of its way: a uniform density of it has 2.9 / 3
    assert [found[name].told for name in ("p0", "p1", "p2")] == [False, True, True]
    assert (found["p0"].low, found["p0"].high) == (0.0, 10.0)
    assert found["p1"].high - 2.0 == pytest.approx(2.26 * 0.91, rel=0.05)
    nearly = by_name(fitted([x, -3.0 * x + 0.05 * np.sin(x * 9.0), y]))
    assert all(one.told for one in nearly.values()) and nearly["p0"].high - nearly["p0"].low > 1.0


def test_an_end_without_a_bound_is_null_for_programs() -> None:
    row = by_name(fitted([np.zeros(WINDOWS)], high=math.inf))["p0"].row
    assert json.loads(json.dumps(row, allow_nan=False)) == {"ci95": [0.0, None], "told": False}


def test_nothing_at_all_is_told_without_slopes() -> None:
    assert not covariance_of(fitted([np.zeros(WINDOWS)] * 2), CHAPTERS).told.any()
    assert not covariance_of(fitted([np.zeros(WINDOWS)] * 2, high=math.inf), CHAPTERS).told.any()
    lines = [np.linspace(-1.0, 1.0, WINDOWS), np.cos(np.arange(WINDOWS))]
    assert covariance_of(fitted(lines), CHAPTERS).told.all()


def test_what_moves_with_another_that_has_little_room_is_told() -> None:
    # the zero of a counter is known to one step, whatever the readings say of it
    x = np.linspace(-1.0, 1.0, WINDOWS)
    found = fitted([x, x])
    step = Free("", "p1", 1e-6, -1e-6, 1e-6)
    candidate, slopes = Candidate({"p0": 2.0, "p1": 0.0}, {}), found.slopes * np.array([1.0, 1e-6])
    one, other = intervals(Fitted(candidate, (found.free[0], step), found.features, slopes, 0.0), CHAPTERS)
    [alone] = intervals(fitted([x]), CHAPTERS)
    assert one.told and (one.low, one.high) == pytest.approx((alone.low, alone.high), abs=3e-6)
    assert not other.told and (other.low, other.high) == (-1e-6, 1e-6)
