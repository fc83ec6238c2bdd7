"""A drive whose gain depends on a state is outside the library, with its curve; no names are put together in its place."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from carriage import GAIN, measured_log

from hjcamp.commands.any_plant.law_words import described_term
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.diagnosis.results.candidate_rows import unknown_rows
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant

REACH = 0.06


def test_a_motor_that_is_weaker_off_its_middle_is_outside_and_its_gain_is_drawn(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=8.0, gain=lambda x, v: GAIN / (1.0 + (x / REACH) ** 2))])
    library = load_effects(plant=measured.plant)
    wanted = ("spring", "saturation", "sensor_gain", "quadratic_drag")
    analysis = calibrated(measured, {name: library[name] for name in wanted})
    found = decided(analysis)
    assert found.word == "outside_library" and found.effects == () and found.term is not None
    assert [name for name in found.term.names if name in analysis.search.unknowns] == ["unknown_gain_of_force_over_position"]
    assert found.shown is found.term
    row = unknown_rows(analysis, found)[0]
    assert (row["driver"], row["quantity"], row["port"], row["slots"]) == ("position", "gain", "force", ["force"])
    knots = {"x": np.array(row["knots"]["x"]), "y": np.array(row["knots"]["y"])}
    # the base takes a mean gain: the form of the curve is told, not its size
    shape, true = 1.0 + knots["y"], 1.0 / (1.0 + (knots["x"] / REACH) ** 2)
    inner = np.abs(knots["x"]) < 0.08
    ratio = (shape / true)[inner]
    assert inner.sum() >= 3 and np.ptp(ratio) < 0.25 * ratio.mean()
    json.dumps(row)


def test_a_gain_has_a_driver_of_each_state_and_of_time_that_moves(axis: Path) -> None:
    ranges = {"position": (-0.1, 0.1), "velocity": (0.3, 0.3), "time": (0.0, 9.0)}
    found = unknowns_of(find_plant("axis"), ranges)
    assert {name for name, one in found.items() if one.quantity == "gain"} == {
        "unknown_gain_of_force_over_position",
        "unknown_gain_of_force_over_time",
    }
    one = found["unknown_gain_of_force_over_position"]
    assert (one.place, one.driver, one.signal, one.usual) == ("force", "position", "position", 1.0)


@pytest.mark.parametrize(
    ("driver", "said"), [("velocity", "gain of force that depends on velocity"), ("time", "that depends on time")]
)
def test_the_words_of_a_gain(driver: str, said: str) -> None:
    assert said in described_term({"quantity": "gain", "port": "force", "driver": driver})
