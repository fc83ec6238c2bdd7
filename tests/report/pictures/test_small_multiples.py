"""Small pictures: a line where points show it, an area where they cannot, in words that people read."""

from __future__ import annotations

import re

import numpy as np
import pytest

from hjcamp.records.log import TestLog, observed
from hjcamp.report.pictures.conditions import draw_condition
from hjcamp.report.pictures.small_multiples import AREA_POINTS, HIGH, MOST_POINTS, few_points, small_multiples
from hjcamp.report.runs.spread import Condition, gather

TIME = np.arange(6000) * 1e-3


def sine(hertz: float, backend: str = "simulation") -> Condition:
    """Return 6 s of a sine of 50 deg, measured and wanted, as a report condenses it."""
    wave = 50.0 * np.sin(2.0 * np.pi * hertz * TIME)
    columns = {"time_s": TIME, "reference_deg": wave, "arm_deg": wave + 0.01}
    return gather("sine_fast__ffwd_pid", [TestLog(columns, {"backend": backend})])


@pytest.mark.parametrize("hertz", [0.5, 1.0, 2.0])
def test_a_few_periods_are_a_line_that_reaches_their_peaks(hertz: float) -> None:
    html = small_multiples([sine(hertz)], {"sine_fast__ffwd_pid": "a"}, {})
    assert "<polygon" not in html
    heights = [float(one.split(",")[1]) for one in re.findall(r'<polyline points="([^"]*)"', html)[0].split()]
    assert len(heights) <= MOST_POINTS
    assert min(heights) < 0.1 * HIGH and max(heights) > 0.9 * HIGH


@pytest.mark.parametrize("hertz", [5.0, 37.0, 66.667, 133.334])
def test_many_periods_are_an_area_of_their_whole_height(hertz: float) -> None:
    # at 66.667 Hz a point stands for one period: means alone would be a straight line
    html = small_multiples([sine(hertz)], {"sine_fast__ffwd_pid": "a"}, {})
    assert html.count("<polygon") == 2 and "<polyline" not in html
    signal = few_points(sine(hertz).signals["arm_deg"], AREA_POINTS)
    inside = slice(2, -2)
    assert np.median(signal.highest[inside]) > 45.0 and np.median(signal.lowest[inside]) < -45.0


def test_names_are_words_and_what_was_simulated_is_called_so() -> None:
    one = sine(1.0)
    assert "sine fast, feedforward PID" in small_multiples([one], {one.name: "a"}, {})
    assert ">simulated<" in draw_condition(one) and ">measured<" in draw_condition(sine(1.0, "nidaqmx"))
    logs = [TestLog({"time_s": TIME}, {"backend": name} if name else {}) for name in ("simulation", "nidaqmx", "")]
    assert [observed(logs[:1]), observed(logs[1:2]), observed(logs[2:]), observed(logs)] == ["simulated"] + 3 * ["measured"]


def test_one_test_that_swings_fast_has_its_range_in_the_large_picture() -> None:
    assert sine(66.667).banded and not sine(1.0).banded


@pytest.mark.parametrize(("phase", "aligned"), [(0.0, True), (0.1, True), (2.0, False)])
def test_a_mean_is_drawn_where_repetitions_align_and_one_of_them_where_they_do_not(phase: float, aligned: bool) -> None:
    time = np.linspace(0.0, 4.0, 4000)
    courses = [np.sin(6.0 * time + phase * k) for k in range(5)]
    wanted = np.zeros(len(time))
    logs = [
        TestLog({"time_s": time, "phase": np.full(len(time), 3.0), "arm_deg": one, "reference_deg": wanted}, {})
        for one in courses
    ]
    found = gather("hunts", logs)
    bold, others = found.lines("arm_deg")
    assert found.aligned is aligned and len(others) == (0 if aligned else 4)
    expected = np.mean(courses, axis=0) if aligned else courses[0]
    assert bold == pytest.approx(np.interp(found.time, time, expected), abs=0.02)
    # what was wanted is the same in all, and one line
    assert found.lines("reference_deg")[1] == ()
    drawn = draw_condition(found)
    assert drawn.count("stroke-width: 0.4") >= (0 if aligned else 4) and ("stroke-width: 0.4" in drawn) is not aligned
