"""A model errs by the same on the same tests, whichever models stand beside it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from carriage import COULOMB, MASS, VISCOUS, measured_log

from hjcamp.effects import load_effects
from hjcamp.model.candidate import Candidate
from hjcamp.prediction.comparison import compared
from hjcamp.prediction.measured.tests import measured_tests


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
