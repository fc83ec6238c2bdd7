"""Shapes are tried where the tests have been, and every amplitude of an effect is probed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.equivalence import law_of
from hjcamp.diagnosis.candidates.visited_range import largest_commands, visited_shapes
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.screening.settings import amplitudes_of, shape_grid
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.language.vocabulary import read_vocabulary

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


def test_a_dead_band_keeps_no_more_to_itself_than_was_commanded(axis: Path) -> None:
    plant = find_plant("axis")
    library = load_effects(plant=plant)
    signal = next(port.names["command"] for port in read_vocabulary(plant).ports.values() if port.kind == "actuator")
    assert largest_commands(library["dead_band"], plant, {signal: (-3.0, 2.0)}) == {"width": 3.0}
    # of a shape the range is visited, and what is no actuator's commands nothing
    assert largest_commands(library["saturation"], plant, {signal: (-3.0, 2.0)}) == {}
    assert largest_commands(library["spring"], plant, HERE) == {} == largest_commands(load_effects()["leakage"], plant, HERE)
    search = calibrated(measured_tests([measured_log()]), library, unknowns=False).search
    [free] = [one for one in search.free_of(Candidate({}, {"dead_band": {"width": 0.1}})) if one.effect]
    low, high = search.ranges[signal]
    assert free.high == min(max(-low, high), library["dead_band"].parameters["width"].bounds[1])


def test_what_one_store_loses_and_another_gains_is_tried_over_the_levels_of_the_one(tanks: Path) -> None:
    plant = find_plant("tanks")
    levels = {"upper": (1.0, 20.0), "lower": (0.5, 6.0)}
    assert visited_shapes(load_effects(plant=plant)["spill_over"], plant, levels) == {"brim": (1.0, 20.0)}


def test_what_is_visited_is_what_the_log_shows(axis: Path) -> None:
    measured = measured_tests([measured_log()])
    analysis = calibrated(measured, {}, unknowns=False)
    low, high = analysis.search.ranges["position"]
    read = measured.tests[0].readings[:, 0]
    assert low == pytest.approx(np.percentile(read, 1.0), abs=2e-3) and high == pytest.approx(
        np.percentile(read, 99.0), abs=2e-3
    )


def test_each_amplitude_that_is_no_shape_is_probed() -> None:
    library = load_effects()
    assert amplitudes_of(library["leakage"]) == ("conductance", "conductance_above")
    assert amplitudes_of(library["presliding"]) == ("compliance",)


def test_two_laws_of_one_driver_in_one_place_are_one(axis: Path) -> None:
    library = load_effects(plant=find_plant("axis"))
    similar = [name for name in library if law_of(library[name]) == law_of(library["spring"])]
    assert similar == ["cubic_spring", "soft_stop", "spring"]
    for name in ("hard_stop", "position_friction", "sensor_gain"):
        assert law_of(library[name]) and law_of(library[name]) != law_of(library["spring"]), name
    # no driver, or a memory: nothing to compare
    assert law_of(library["constant_force"]) is None and law_of(library["friction_drift"]) is None
