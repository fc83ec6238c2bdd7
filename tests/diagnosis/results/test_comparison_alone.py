"""A model errs by the same on the same tests, whichever models stand beside it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
from carriage import COULOMB, MASS, VISCOUS, measured_log

from hjcamp.commands.any_plant.comparison_words import further_off
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.results.comparison import compared
from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate


def test_a_model_errs_by_the_same_whichever_stands_beside_it(axis: Path) -> None:
    measured = measured_tests([measured_log(lambda x, v: -150.0 * (x - 0.03), seconds=6.0)])
    library = load_effects(plant=measured.plant)
    base = {"mass": MASS, "coulomb": COULOMB, "viscous": VISCOUS}
    right = Candidate(base, {"spring": {"stiffness": 150.0, "rest_position": 0.03}})
    far = Candidate({"mass": 3.0 * MASS, "coulomb": 20.0 * COULOMB, "viscous": 0.1}, {})
    found = [
        next(one for one in compared(measured, library, models).models if one.name == "right").rms
        for models in ({"right": right}, {"far": far, "right": right}, {"right": right, "far": far})
    ]
    assert np.ptp(np.array(found), axis=0).max() < 0.01 * found[0].min()


def test_it_is_said_why_a_model_that_errs_less_in_a_channel_is_farther_off() -> None:
    sensors = [SimpleNamespace(quantity="arm_angle"), SimpleNamespace(quantity="speed")]
    calibrated = SimpleNamespace(name="calibrated", rms=[0.5, 0.5], score=1.0)
    models = [
        SimpleNamespace(name="first", rms=[1.0, 1.0], score=2.0),
        SimpleNamespace(name="second", rms=[2.0, 0.7], score=3.0),
    ]
    found = SimpleNamespace(
        models=models, calibrated=calibrated, analysis=SimpleNamespace(measured=SimpleNamespace(sensors=sensors))
    )
    said = further_off(found)  # type: ignore[arg-type]
    assert said[-1].startswith("second errs less in speed than first, though its normalised error is larger: ")
    calibrated.rms = [3.0, 0.5]
    assert further_off(found)[-1].startswith("first errs less in arm angle than what is calibrated here")  # type: ignore[arg-type]
    calibrated.rms, models[1].rms = [0.5, 0.5], [2.0, 1.0]
    assert not [one for one in further_off(found) if "errs less" in one]  # type: ignore[arg-type]
