"""Calibrate the base parameters first: another rig has its own friction and stiffness, and that is not an effect."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit, Fitter
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import base_unknowns, effect_unknowns
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import HOME, Views

Array = NDArray[np.float64]
NOISE = np.array([2e-3, 700.0, 700.0, 700.0, 0.02, 0.05, 2e-3])
RATIOS = (1.15, 1.37)


def direct_estimate(evidence: Evidence) -> dict[str, float]:
    """Return base parameters read off the logs without any simulation: sliding force by direction, dp/dV.

    Sliding friction is the median push while the arm moves; dp/dV the slope of the pressure difference over the
    volume that pump and arm do not share (thesis 4.4.3.16, 4.5.1).
    """
    values = evidence.tests[0].hardware.values
    area, pump_area = values["joint_area"], values["pump_area"]
    lead, radius = values["pump_lead"], values["pulley_radius"]
    rows: list[Array] = []
    pushes: dict[float, list[Array]] = {1.0: [], -1.0: []}
    for test in evidence.tests:
        difference = test.pressure1 - test.pressure2
        volume = pump_area * lead * test.pump - area * radius * test.arm
        rows.append(np.column_stack([volume - volume.mean(), difference - difference.mean()]))
        for direction, found in pushes.items():
            found.append(np.column_stack([difference, np.abs(test.velocity)])[test.velocity * direction > 2e-3])
    both = np.vstack(rows)
    estimate: dict[str, float] = {}
    square, product = float(both[:, 0] @ both[:, 0]), float(both[:, 0] @ both[:, 1])
    low, high = PumpJoint.parameters["line_stiffness"].bounds
    # Pressures that do not rise with the volume tell no stiffness: the published one is where the fit begins.
    if square > 0.0 and low <= product / (2 * square) <= high:
        estimate["line_stiffness"] = product / (2 * square)
    for direction, name in ((1.0, "positive"), (-1.0, "negative")):
        seen = np.vstack(pushes[direction])
        if len(seen) < 20:
            continue
        viscous = values[f"viscous_{name}"]
        sliding = float(np.median(direction * seen[:, 0] * area - viscous * seen[:, 1]))
        estimate[f"coulomb_{name}"] = min(max(sliding, 0.1), PumpJoint.parameters[f"coulomb_{name}"].bounds[1])
        estimate[f"viscous_{name}"] = viscous
    return estimate


def calibrate(
    views: Views,
    features: Features,
    least: Array | None = None,
    start: Candidate | None = None,
) -> tuple[Fit, Fitter]:
    """Return the base parameters fitted from several shapes of friction, and the fitter that weighs by their floor.

    The effects that the model ``start`` has already are fitted with them.
    """
    known = start or Candidate({})
    own = [unknown for effect in views.effects if effect.name in known.effects for unknown in effect_unknowns(effect)]
    unknowns = base_unknowns() + own
    estimate = direct_estimate(views.evidence)
    fitter = Fitter(views, features, NOISE if least is None else least)
    starts = [known] if start is not None else []
    for ratio in RATIOS:
        base = dict(estimate)
        for name in ("positive", "negative"):
            if f"coulomb_{name}" in base:
                base[f"static_{name}"] = ratio * base[f"coulomb_{name}"]
        starts.append(known.with_base(base))
    fits = views.crew.together(lambda one: fitter.fit(one, unknowns, steps=6), starts)
    best = min(fits, key=lambda fit: fit.loss)
    if least is not None:
        return best, fitter
    least = np.maximum(0.5 * features.noise_floor(best.features), 0.3 * NOISE)
    least[HOME] = views.evidence.home_scatter
    fitter = Fitter(views, features, least)
    return fitter.fit(best.candidate, unknowns, steps=8), fitter
