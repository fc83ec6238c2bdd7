"""A figure that is filled again looks as if it were drawn for the first time."""

from __future__ import annotations

import numpy as np
import pytest
from report_samples import make_log

from hjcamp.records.log import TestLog
from hjcamp.report.pictures import conditions as figures
from hjcamp.report.pictures.conditions import draw_condition
from hjcamp.report.runs.spread import Condition, gather


def scattered(trajectory: str, scale: float, repetitions: int = 2) -> Condition:
    """A condition whose limits, ticks and bands are those of ``scale``."""
    random = np.random.default_rng(5)
    logs = [make_log(trajectory, repetition=number) for number in range(1, repetitions + 1)]
    for log in logs:
        log.columns["arm_deg"] += scale * random.normal(size=log.samples)
        log.columns["pressure1_mpa"] *= scale
    return gather(f"{trajectory}_{scale}", logs)


@pytest.fixture(autouse=True)
def no_frames() -> None:
    figures._frame.cache_clear()


def test_a_figure_filled_again_is_one_made_for_it() -> None:
    conditions = [scattered("ramp_pos", 0.1), scattered("sine_0p5hz", 40.0), scattered("cycloid_neg", 3.0)]
    again = [draw_condition(one) for one in conditions] + [draw_condition(conditions[0])]
    assert figures._frame.cache_info().misses == 1
    assert again[0] == again[3] and len(set(again)) == 3
    for condition, drawn in zip(conditions, again, strict=False):
        figures._frame.cache_clear()
        assert draw_condition(condition) == drawn


def test_other_signals_and_a_single_test_have_a_figure_of_their_own() -> None:
    log = make_log("ramp_pos")
    sparse = TestLog({name: log.columns[name] for name in ("time_s", "arm_deg")})
    conditions = [scattered("ramp_pos", 1.0), scattered("ramp_pos", 1.0, 1), gather("b", [sparse])]
    drawn = [draw_condition(one) for one in conditions]
    assert figures._frame.cache_info().misses == 3
    # The bands are the only surfaces: none without repetitions.
    assert ["fill-opacity: 0.22" in svg for svg in drawn] == [True, False, False]
    assert ["Pressure" in svg for svg in drawn] == [True, True, False]


def test_a_condition_without_samples_leaves_nothing_of_the_one_before() -> None:
    empty = Condition("empty", 1, np.empty(0), {})
    before = draw_condition(empty)
    draw_condition(scattered("ramp_pos", 1.0, 1))
    assert draw_condition(empty) == before
