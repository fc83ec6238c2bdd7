"""Rivals are weighed by their errors and by what they ask of base parameters that are known beforehand."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
from hjcamp.plants.pump_joint.diagnosis.screening.screening import asks, rival_weights

EFFECTS = tuple(load_effects([]).values())
LEAST = np.ones(3)


def fitted(name: str, base: dict[str, float] | None = None) -> Fit:
    candidate = Candidate(base or {}).with_effect(name, {})
    error = np.ones((4, 3))
    return Fit(candidate, float(np.log(error + 1.0).sum()) + asks(candidate, ()), np.zeros((0, 3)), error)


def test_a_model_asks_for_what_it_moves_and_for_its_amplitudes_and_shapes() -> None:
    moved = {"stiffness_asymmetry": 3.0 * PumpJoint.uncertain["stiffness_asymmetry"]}
    assert asks(Candidate({}), EFFECTS) == 0.0
    assert asks(Candidate(moved), EFFECTS) == pytest.approx(9.0)
    assert asks(Candidate({}).with_effect("payload_inertia", {}), EFFECTS) == 2.0
    assert asks(Candidate({}).with_effect("line_inertance", {}), EFFECTS) == 4.0


def test_an_effect_of_an_unusual_size_asks_for_more() -> None:
    usual = EFFECTS[[effect.name for effect in EFFECTS].index("line_inertance")].parameters["inertance"]
    at = {factor: Candidate({}).with_effect("line_inertance", {"inertance": factor * usual.default}) for factor in (1, 9, 0)}
    assert asks(at[1], EFFECTS) == pytest.approx(4.0)
    assert asks(at[9], EFFECTS) == pytest.approx(4.0 + 2.0**2)
    assert np.isfinite(asks(at[0], EFFECTS))
    # 0.4 kg at the sliders: a brass payload, or thirty times the water of the tube
    payload = Candidate({}).with_effect("payload_inertia", {"load_mass": 0.0113, "radius": 0.0203})
    tube = Candidate({}).with_effect("line_inertance", {"inertance": 1.27e9, "far_share": 0.0})
    assert asks(tube, EFFECTS) > asks(payload, EFFECTS) + 8.0


def test_equal_errors_are_told_apart_by_what_is_known_of_the_rig() -> None:
    unlike = {"stiffness_asymmetry": 4.0 * PumpJoint.uncertain["stiffness_asymmetry"]}
    fits = {"pressure_gain": fitted("pressure_gain"), "dither_relief": fitted("dither_relief", unlike)}
    weights = rival_weights(fits, LEAST, EFFECTS)
    assert weights["dither_relief"] / weights["pressure_gain"] == pytest.approx(np.exp(-8.0))
