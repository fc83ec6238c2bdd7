"""Hidden forces on a carriage that shares no code with the program: named, outside, or nothing."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from asked import analysed, asked
from carriage import measured_log, nothing
from threadpoolctl import threadpool_info, threadpool_limits

from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.results.answer import answer

LIBRARY = ("constant_force", "quadratic_drag", "spring")


def both(x: float, v: float) -> float:
    """A force that no law of one quantity has, nor one that is so many times another."""
    return -2500.0 * x * abs(v)


def content_of(force: Any, seconds: float = 8.0, noise: float = 0.0) -> dict[str, Any]:
    found = answer(*asked(measured_tests([measured_log(force, seconds=seconds, noise=noise)]), LIBRARY), 0.0)
    return dict(json.loads(json.dumps(found, allow_nan=False)))


def test_a_spring_is_named_with_its_stiffness(axis: Path) -> None:
    found = content_of(lambda x, v: -150.0 * (x - 0.03))
    assert (found["verdict"], found["effects"]) == ("effect", ["spring"])
    assert found["error"]["augmented"] < 0.5 * found["error"]["baseline"]
    row = found["candidates"][0]["parameters"]["stiffness"]
    assert row["value"] == pytest.approx(150.0, rel=0.01)
    assert row["ci95"][1] - row["ci95"][0] < 0.1 * 150.0


@pytest.mark.study
def test_a_drag_is_named(axis: Path) -> None:
    found = content_of(lambda x, v: -900.0 * v * abs(v))
    assert (found["verdict"], found["effects"]) == ("effect", ["quadratic_drag"])


def test_nothing_is_missing(axis: Path) -> None:
    found = content_of(nothing, noise=2e-6)
    assert found["verdict"] == "nothing_missing" and found["effects"] == [] and found["unknowns"] == []
    assert found["follows_motion"] == {"share": 0.0, "quantities": []}


def test_waves_along_the_travel_are_outside_and_their_curve_is_drawn(axis: Path) -> None:
    found = content_of(lambda x, v: 8.0 * np.sin(2.0 * np.pi * x / 0.06))
    assert found["verdict"] == "outside_library" and found["drivers"][0] in ("velocity_position", "friction_travel")
    first = found["unknowns"][0]
    assert first["quantity"] == "force" and first["left"] < 0.7
    curve = first["curve"]
    assert len(curve["x"]) == len(curve["y"]) and curve["x_unit"] == "m" and curve["y_unit"] == "N"


def test_what_depends_on_two_quantities_is_outside_though_no_law_of_one_takes_it(axis: Path) -> None:
    found = content_of(both)
    assert (found["verdict"], found["effects"], found["drivers"]) == ("outside_library", [], [])
    follows = found["follows_motion"]
    assert follows["share"] > 0.5 and "position" in " ".join(follows["quantities"])


def test_what_is_so_many_times_a_speed_depending_on_the_place_is_a_damping_over_it(axis: Path) -> None:
    found = content_of(lambda x, v: -2500.0 * x * v)
    row = found["unknowns"][0]
    assert found["verdict"] == "outside_library"
    assert (row["quantity"], row["port"], row["driver"]) == ("damping", "friction", "friction_travel")
    x, y = np.array(row["curve"]["x"]), np.array(row["curve"]["y"])
    # in N s/m
    assert np.polyfit(x, y, 1)[0] == pytest.approx(2500.0, rel=0.15)


@pytest.mark.study
def test_a_name_that_takes_less_than_a_regression_still_finds_is_no_answer(axis: Path) -> None:
    # a spring is there, and with it what no law of the library has: three times as much
    found = content_of(lambda x, v: -50.0 * (x - 0.03) + both(x, v))
    assert (found["verdict"], found["effects"]) == ("outside_library", [])
    assert found["law_left"] > 0.5 and found["follows_motion"]["share"] > 0.5


def test_few_tests_cannot_tell(axis: Path) -> None:
    with threadpool_limits(2, user_api="blas"):
        analysis, verdict = asked(measured_tests([measured_log(seconds=0.6)]), ["constant_force", "spring"], unknowns=False)
        assert {row["num_threads"] for row in threadpool_info() if row["user_api"] == "blas"} == {1}
    found = answer(analysis, verdict, 0.0)
    assert found["verdict"] == "cannot_tell" and found["lacking"]


def test_nothing_is_missing_is_not_said_of_a_base_that_its_bounds_hold(axis: Path) -> None:
    file = axis / "plants" / "axis.py"
    file.write_text(file.read_text().replace("(1.0, 1e3)", "(90.0, 1e3)"))  # 80 kg is right
    found = decided(analysed(measured_tests([measured_log()]), unknowns=False))
    assert found.word == "cannot_tell" and found.lacking[-1].startswith(
        "mass was driven to its bound, far from what is declared"
    )
