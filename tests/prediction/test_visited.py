"""Shapes are tried where the tests have been, and every amplitude of an effect is probed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import measured_log

from hjcamp.effects import load_effects
from hjcamp.plants import find_plant
from hjcamp.prediction.analysis import calibrated
from hjcamp.prediction.measured import measured_tests
from hjcamp.prediction.screening import amplitudes_of, shape_grid
from hjcamp.prediction.visited import visited_shapes

HERE = {"position": (-0.02, 0.16), "velocity": (-0.3, 0.3)}


def test_a_place_and_a_length_are_tried_over_the_visited_travel(axis: Path) -> None:
    plant = find_plant("axis")
    library = load_effects(plant=plant)
    for name, shape in (("spring", "rest_position"), ("position_friction", "period")):
        assert visited_shapes(library[name], plant, HERE) == {}, f"{name}: {shape} has another signal"
    ranges = {state: HERE["position"] for state in plant.states} | HERE
    stop = visited_shapes(library["hard_stop"], plant, ranges)
    assert stop == {"end": (-0.02, 0.16)}
    tried = {one["end"] for one in shape_grid(library["hard_stop"], stop) if one}
    assert min(tried) == pytest.approx(-0.02 + 0.18 / 5.0) and max(tried) == pytest.approx(0.16 - 0.18 / 5.0)
    friction = visited_shapes(library["position_friction"], plant, ranges)
    periods = {one["period"] for one in shape_grid(library["position_friction"], friction) if one}
    assert min(periods) == pytest.approx(0.18 / 8.0) and max(periods) == pytest.approx(0.18)


def test_what_is_visited_is_what_the_log_shows(axis: Path) -> None:
    measured = measured_tests([measured_log()])
    analysis = calibrated(measured, {}, unknowns=False)
    low, high = analysis.search.ranges["position"]
    read = measured.tests[0].readings[:, 0]
    assert low == pytest.approx(np.percentile(read, 1.0), abs=2e-3) and high == pytest.approx(np.percentile(read, 99.0), abs=2e-3)


def test_each_amplitude_that_is_no_shape_is_probed() -> None:
    library = load_effects()
    assert amplitudes_of(library["leakage"]) == ("conductance", "conductance_above")
    assert amplitudes_of(library["presliding"]) == ("compliance",)
