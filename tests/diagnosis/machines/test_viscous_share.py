"""Grease that is stiff in one place changes viscous friction, and may leave dry friction as it is."""

from __future__ import annotations

from pathlib import Path

import pytest
from carriage import VISCOUS, measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.effects import load_effects

PLACE, HALF_WIDTH, SHARE = 0.03, 0.015, 0.6


def test_a_stiff_place_of_viscous_friction_is_friction_that_depends_on_the_place(axis: Path) -> None:
    """A bump of the form of a resonance, which no law of the library has."""

    def rub(x: float, v: float) -> float:
        return -VISCOUS * SHARE * v / (1.0 + ((x - PLACE) / HALF_WIDTH) ** 2)

    measured = measured_tests([measured_log(rub)])
    library = load_effects(plant=measured.plant)
    names = ("position_friction", "friction_drift", "quadratic_drag", "coulomb_asymmetry", "spring")
    analysis = calibrated(measured, {name: library[name] for name in names}, unknowns=False)
    found = decided(analysis)
    assert found.word == "effect" and found.effects == ("position_friction",)
    values = found.model.fitted.candidate.effects["position_friction"]
    assert values["viscous_amplitude"] == pytest.approx(SHARE, abs=0.2) and values["amplitude"] < 0.2
