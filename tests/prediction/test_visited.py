"""Shapes are tried where the tests have been, and every amplitude of an effect is probed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import measured_log

from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.prediction.laws.alike import law_of
from hjcamp.prediction.laws.visited import visited_shapes
from hjcamp.prediction.measured.tests import measured_tests
from hjcamp.prediction.screening.screening import amplitudes_of, shape_grid
from hjcamp.prediction.selection.analysis import calibrated

HERE = {"position": (-0.02, 0.16), "velocity": (-0.3, 0.3)}


def test_a_place_and_a_length_are_tried_over_the_visited_travel(axis: Path) -> None:
    plant = find_plant("axis")
    library = load_effects(plant=plant)
    assert visited_shapes(library["position_friction"], plant, {"voltage": (-1.0, 1.0)}) == {}
    stop = visited_shapes(library["hard_stop"], plant, HERE)
    assert stop == {"end": (-0.02, 0.16)}
    tried = {one["end"] for one in shape_grid(library["hard_stop"], stop) if one}
    assert min(tried) == pytest.approx(-0.02 + 0.18 / 5.0) and max(tried) == pytest.approx(0.16 - 0.18 / 5.0)
    friction = visited_shapes(library["position_friction"], plant, HERE)
    periods = {one["period"] for one in shape_grid(library["position_friction"], friction) if one}
    assert min(periods) == pytest.approx(0.18 / 8.0) and max(periods) == pytest.approx(0.18)


def test_what_one_store_loses_and_another_gains_is_tried_over_the_levels_of_the_one(tanks: Path) -> None:
    plant = find_plant("tanks")
    levels = {"upper": (1.0, 20.0), "lower": (0.5, 6.0)}
    assert visited_shapes(load_effects(plant=plant)["spill_over"], plant, levels) == {"brim": (1.0, 20.0)}


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


def test_two_laws_of_one_driver_in_one_place_are_one(axis: Path) -> None:
    library = load_effects(plant=find_plant("axis"))
    alike = [name for name in library if law_of(library[name]) == law_of(library["spring"])]
    assert alike == ["cubic_spring", "soft_stop", "spring"]
    for name in ("hard_stop", "position_friction", "sensor_gain"):
        assert law_of(library[name]) and law_of(library[name]) != law_of(library["spring"]), name
    # no driver, or a memory: nothing to compare
    assert law_of(library["constant_force"]) is None and law_of(library["friction_drift"]) is None
