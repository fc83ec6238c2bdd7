"""Friction that differs a little from place to place is how friction is; where it differs by much, it is an effect."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import COULOMB, measured_log

from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.effects import load_effects

LENGTH = 0.09


@pytest.mark.parametrize(("share", "said"), [(0.025, "nothing_missing"), (0.15, "effect")])
def test_friction_that_differs_by_what_every_contact_has_is_no_effect(axis: Path, share: float, said: str) -> None:
    """A triangle along the travel, of that share of the friction at its ends: no sine, and its rms is the share over root 3."""

    def rub(x: float, v: float) -> float:
        place = x / LENGTH - np.floor(x / LENGTH)
        return float(-np.sign(v) * COULOMB * share * (4.0 * abs(place - 0.5) - 1.0))

    measured = measured_tests([measured_log(rub)])
    library = load_effects(plant=measured.plant)
    analysis = calibrated(measured, {name: library[name] for name in ("position_friction", "spring")}, unknowns=False)
    found = decided(analysis)
    assert found.word == said and found.effects == (("position_friction",) if said == "effect" else ())


def test_friction_over_place_or_time_scatters_and_nothing_else_does(axis: Path) -> None:
    measured = measured_tests([measured_log(seconds=2.0)])
    library = load_effects(plant=measured.plant)
    assert [name for name, one in library.items() if one.scatters] == ["friction_drift", "position_friction"]
    ranges = dict.fromkeys(("position", "velocity", "voltage", "time", "dry"), (-1.0, 1.0))
    names = {name for name, one in unknowns_of(measured.plant, ranges).items() if one.scatters}
    assert names == {f"unknown_{what}_over_{driver}" for what in ("friction", "damping") for driver in ("travel", "time")}
