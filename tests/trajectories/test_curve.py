"""A curve through values at equal steps of time: it goes through them, at rest at both ends, in the unit of its plant."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hjcamp.errors import UsageError
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.trajectories import build_trajectory

VALUES = st.lists(st.floats(-500.0, 500.0), min_size=2, max_size=30)


@settings(deadline=None, max_examples=30)
@given(VALUES, st.floats(1e-3, 10.0))
def test_it_goes_through_its_values_and_rests_at_both_ends(more: list[float], step: float) -> None:
    curve = build_trajectory({"kind": "curve", "values_deg": [0.0, *more], "step_time": step})
    time = np.arange(len(more) + 1) * step
    assert np.allclose(np.degrees(curve.reference(time)[0]), [0.0, *more], atol=1e-9 * (1.0 + np.abs(more).max()))
    assert curve.duration == pytest.approx(len(more) * step)
    speed = 500.0 / step
    assert abs(curve.motion(np.zeros(1))[1][0]) < 1e-9 * speed and not curve.reference(time[-1:] + step)[1].any()


def test_its_values_are_in_the_unit_of_the_plant() -> None:
    unit = unit_of_field("position_mm", "a test")
    curve = build_trajectory({"kind": "curve", "values_mm": [0.0, 10.0, 20.0], "step_time": 0.5}, unit=unit)
    assert np.degrees(curve.reference(np.array(0.5))[0]) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("given_values", "says"),
    [
        ([0.0, 1.0], "3 to"),
        ("0 1 2", "3 to"),
        (1.0, "3 to"),
        ([1.0, 2.0, 3.0], "begins at 0"),
        ([0.0, "far", 3.0], r"values_deg\[1\] is 'far'"),
        ([0.0, float("nan"), 3.0], r"values_deg\[1\] is nan"),
        ([0.0, 1e9, 3.0], r"values_deg\[1\]"),
    ],
)
def test_what_is_no_curve_is_refused(given_values: Any, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        build_trajectory({"kind": "curve", "values_deg": given_values, "step_time": 0.1})
    with pytest.raises(UsageError, match="step_time"):
        build_trajectory({"kind": "curve", "values_deg": [0.0, 1.0, 2.0], "step_time": 0.0})
