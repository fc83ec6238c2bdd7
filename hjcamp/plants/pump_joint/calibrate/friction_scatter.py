"""How far friction differs from one test to the next, and along the travel within a test."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hjcamp.plants.pump_joint.calibrate.estimate import Estimate
from hjcamp.plants.pump_joint.calibrate.plateaus import Plateau

LONG_S = 0.8  # several times the length over which friction along the travel is alike


def friction_scatter(plateaus: Sequence[Plateau], lines: dict[float, tuple[float, float]]) -> list[Estimate]:
    """Return the relative standard deviations of Coulomb friction between tests and within a test.

    ``lines`` gives (Coulomb, viscous) friction for each direction. What both directions of one test share differs
    between tests: its covariance over the tests is the square of the first number. The second is that of the force
    along strokes longer than 0.8 s.
    """
    relative: dict[float, dict[int, list[float]]] = {sign: {} for sign in lines}
    for one in plateaus:
        if one.direction in lines:
            coulomb, viscous = lines[one.direction]
            own = relative[one.direction].setdefault(one.test, [])
            own.append((one.force - viscous * one.speed) / coulomb - 1.0)
    found = []
    both = sorted(set.intersection(*(set(tests) for tests in relative.values()))) if len(relative) == 2 else []
    if len(both) > 4:
        positive, negative = ([float(np.mean(tests[test])) for test in both] for tests in relative.values())
        between = float(np.sqrt(max(np.cov(np.array([positive, negative]))[0, 1], 0.0)))
        text = "scatter of friction between tests"
        found.append(Estimate("friction_between", between, "1", None, len(both), text, "%", 100.0))
    known = [one for one in plateaus if one.seconds > LONG_S and one.direction in lines]
    longest = [one.scatter / lines[one.direction][0] for one in known]
    if longest:
        within = float(np.sqrt(np.mean(np.square(longest))))
        text = "scatter of friction within a test"
        found.append(Estimate("friction_within", within, "1", None, len(longest), text, "%", 100.0))
    return found
