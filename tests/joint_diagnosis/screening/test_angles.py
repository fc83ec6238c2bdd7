"""An angle is one of two amplitudes to the screening, and has no ends to the fit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import effect_unknowns, read, written
from hjcamp.plants.pump_joint.diagnosis.screening.responses import Probe, angle_of, shapes

LIBRARY = load_effects([])


def test_only_a_shape_that_turns_one_amplitude_is_an_angle() -> None:
    found = {name: angle_of(effect) for name, effect in LIBRARY.items() if angle_of(effect)}
    assert found == {"encoder_eccentricity": "phase", "gravity_load": "rest_angle", "position_friction": "phase"}
    assert list(shapes(LIBRARY["encoder_eccentricity"])) == [{}]


@pytest.mark.parametrize("angle", [0.0, 1.0, math.pi / 2, 3.0, -2.5])
def test_two_columns_give_every_amplitude_and_angle(angle: float) -> None:
    probe = Probe("e", {}, ("a", "a"), (0, 1), (True, True), ((), ()), (0.1, 0.4), (0.0, math.pi / 2), "phase")
    found = probe.lifts(np.array([0.2 * math.cos(angle) / 0.1, 0.2 * math.sin(angle) / 0.4]))
    assert found["a"] == pytest.approx(0.2)
    assert math.remainder(found["phase"] - angle, math.tau) == pytest.approx(0.0, abs=1e-12)


def test_an_angle_that_is_fitted_passes_half_a_turn() -> None:
    unknowns = effect_unknowns(LIBRARY["position_friction"])
    names = [unknown.name for unknown in unknowns]
    start = Candidate({}, {"position_friction": {"amplitude": 0.2, "period": 6.0, "phase": 3.1}})
    places = read(start, unknowns)
    places[names.index("phase")] += 0.1 / unknowns[names.index("phase")].scale
    moved = written(start, unknowns, places).effects["position_friction"]
    assert moved["phase"] == pytest.approx(3.2 - math.tau)
    assert moved["amplitude"] == pytest.approx(0.2)
