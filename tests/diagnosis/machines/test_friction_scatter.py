"""Friction that differs from place to place is named as that, with its share, however little it differs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import COULOMB, measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.effects import load_effects

LENGTH = 0.09


@pytest.mark.parametrize("share", [0.025, pytest.param(0.15, marks=pytest.mark.study)])
def test_friction_that_differs_along_the_travel_is_named(axis: Path, share: float) -> None:
    """A triangle along the travel, of that share of the friction at its ends: no sine, and its rms is the share over root 3."""

    def rub(x: float, v: float) -> float:
        place = x / LENGTH - np.floor(x / LENGTH)
        return float(-np.sign(v) * COULOMB * share * (4.0 * abs(place - 0.5) - 1.0))

    measured = measured_tests([measured_log(rub)])
    library = load_effects(plant=measured.plant)
    names = ("position_friction", "friction_drift", "quadratic_drag", "coulomb_asymmetry", "spring")
    analysis = calibrated(measured, {name: library[name] for name in names}, unknowns=False)
    found = decided(analysis)
    assert (found.word, found.effects) == ("effect", ("position_friction",))
    amplitude = found.model.fitted.candidate.effects["position_friction"]["amplitude"]
    assert 0.5 * share < amplitude < 1.5 * share
