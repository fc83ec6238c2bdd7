"""Intervals of fitted parameters: of straight lines as textbooks have them, and none where nothing tells a parameter."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from hjcamp.model.candidate import Candidate
from hjcamp.prediction.fitting import Fitted, Free
from hjcamp.prediction.intervals import Interval, intervals, not_told
from hjcamp.report.units import told_interval

WINDOWS = 40
CHAPTERS = np.arange(WINDOWS) // 4


def fitted(columns: list[np.ndarray], high: float = 10.0, noise: float = 0.1) -> Fitted:
    """Return a fit of one feature a window with these slopes, at 2 for each parameter."""
    names = [f"p{number}" for number in range(len(columns))]
    features = noise * np.random.default_rng(3).standard_normal((WINDOWS, 1))
    free = tuple(Free("", name, 1.0, 0.0, high) for name in names)
    slopes = np.stack(columns, axis=1)[:, None, :]
    return Fitted(Candidate(dict.fromkeys(names, 2.0), {}), free, features, slopes, 0.0)


def by_name(found: Fitted) -> dict[str, Interval]:
    return {one.name: one for one in intervals(found, CHAPTERS)}


def test_a_slope_has_the_interval_of_a_straight_line() -> None:
    x = np.linspace(-1.0, 1.0, WINDOWS)
    [one] = intervals(fitted([x]), CHAPTERS)
    # white noise of 0.1 about a line: sigma / sqrt(sum x^2), times Student's t of nine degrees of freedom
    assert one.told and one.high - one.low == pytest.approx(2 * 2.26 * 0.1 / math.sqrt(float(x @ x)), rel=0.5)
    assert one.row == {"ci95": [one.low, one.high]}


def test_what_no_reading_depends_on_may_be_all_that_its_bounds_allow() -> None:
    x = np.linspace(-1.0, 1.0, WINDOWS)
    found = by_name(fitted([x, np.zeros(WINDOWS)]))
    assert found["p0"].told and found["p0"].high - found["p0"].low < 0.3
    assert not found["p1"].told and (found["p1"].low, found["p1"].high) == (0.0, 10.0)
    assert found["p1"].row == {"ci95": [0.0, 10.0], "told": False}
    assert told_interval({"unit": "1", **found["p1"].row}) == "not told by these tests"


def test_two_that_only_act_together_are_not_told_either() -> None:
    x, y = np.linspace(-1.0, 1.0, WINDOWS), np.cos(np.arange(WINDOWS))
    found = by_name(fitted([x, -3.0 * x, y]))
    assert [found[name].told for name in ("p0", "p1", "p2")] == [False, False, True]
    nearly = by_name(fitted([x, -3.0 * x + 1e-4 * np.sin(x * 9.0), y]))
    assert all(one.told for one in nearly.values()) and nearly["p0"].high - nearly["p0"].low > 1.0


def test_an_end_without_a_bound_is_null_for_programs() -> None:
    row = by_name(fitted([np.zeros(WINDOWS)], high=math.inf))["p0"].row
    assert json.loads(json.dumps(row, allow_nan=False)) == {"ci95": [0.0, None], "told": False}


def test_nothing_at_all_is_told_without_slopes() -> None:
    assert not_told(np.zeros((2, 2))).all() and not not_told(np.eye(2)).any()
