"""Of effects that fit alike a step takes the one that asks less, even where another fits a hair better."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from hjcamp.plants.pump_joint.diagnosis.screening.screening import Step


def test_a_step_takes_the_heaviest_of_its_rivals() -> None:
    fits: Any = {"line_inertance": SimpleNamespace(loss=64.9), "payload_inertia": SimpleNamespace(loss=65.5)}
    about: Any = SimpleNamespace(about=SimpleNamespace(loss=100.0))
    step = Step(about, fits, {"line_inertance": 0.01, "payload_inertia": 0.99}, 0.02, np.zeros(3))
    assert step.best == "payload_inertia"
    assert step.gain == 34.5
