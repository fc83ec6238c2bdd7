"""The feedforward against 5.3.1 written out, and inverted by the plant itself."""

from __future__ import annotations

import numpy as np
import pytest
from quiet_loop import AREA1, AREA2, DEGREE, EXACT, RADIUS, STIFFNESS, cycloid

from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.course import Course
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.model.run.simulator import Simulator
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.feedforward import Feedforward

MODEL = Simulator(Composition(PumpJoint))
STATIC, COULOMB, VISCOUS = (7.20, 4.03), (5.27, 2.97), (23.5, 17.2)
PUBLISHED = EXACT | {
    f"{kind}_{way}": pair[side]
    for kind, pair in (("static", STATIC), ("coulomb", COULOMB), ("viscous", VISCOUS))
    for side, way in enumerate(("positive", "negative"))
}


def transcribed(reference: np.ndarray, p1: float, p2: float, first: float, gain: float, experiment: bool) -> np.ndarray:
    """Return the angle of the pump motor, rad (5.3.1.1 to 5.3.1.5); ``experiment`` leaves out what 5.3.3 leaves out."""
    direction, x, before, angles = first, 0.0, 0.0, []
    force: float | None = None
    for theta, speed, acceleration in reference:
        y, dy, ddy = theta * RADIUS, speed * RADIUS, acceleration * RADIUS
        direction = np.sign(dy) or direction
        side = 0 if experiment or direction > 0 else 1
        moving = dy != 0 or ddy != 0
        if moving or force is None:
            force = 0.0185 * ddy + (direction * COULOMB[side] + VISCOUS[side] * dy if moving else 0.0)
        if not moving and not experiment:
            force = direction * STATIC[side]
        volume = (force / AREA2 - p1 + p2) / (2 * STIFFNESS)
        p1, p2 = p1 + STIFFNESS * volume, p2 - STIFFNESS * volume
        x += (volume + (y - before) * AREA2) / AREA1
        before = y
        angles.append(gain * x * 1e3 * 360 * DEGREE)
    return np.array(angles)


@pytest.mark.parametrize("amplitude_deg", [120.0, -120.0])
def test_design_equals_its_transcription(amplitude_deg: float) -> None:
    reference = cycloid(amplitude_deg)
    first = np.sign(amplitude_deg)
    found = Feedforward().command(MODEL, PUBLISHED, reference, (0.36e6, 0.16e6), first)
    expected = transcribed(reference, 0.36e6, 0.16e6, first, 1.0, experiment=False)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("amplitude_deg", [120.0, -120.0])
def test_variant_of_the_experiments_equals_its_transcription(amplitude_deg: float) -> None:
    reference = cycloid(amplitude_deg)[1:1000]
    first = np.sign(amplitude_deg)
    law = Feedforward(gain=1.23, static_friction=False, friction_direction="positive")
    found = law.command(MODEL, PUBLISHED, reference, (0.36e6, 0.16e6), first)
    expected = transcribed(reference, 0.36e6, 0.16e6, first, 1.23, experiment=True)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_plant_without_dry_friction_and_with_a_perfect_pump_follows_the_reference() -> None:
    slippery = {f"{kind}_{way}": 0.0 for kind in ("static", "coulomb") for way in ("positive", "negative")}
    values = PUBLISHED | slippery
    reference = cycloid(120.0, 1.0)
    law = Feedforward(static_friction=False)
    angle = law.command(MODEL, values, reference, (0.3e6, 0.3e6), 1.0)
    joint = Simulator(Composition(PumpJoint, cut=PumpJoint.cut("pump")))
    n = len(reference)
    observed = np.zeros((n, len(PumpJoint.observed)))
    observed[0] = [0.3e6 if name.startswith("pressure") else 0.0 for name in PumpJoint.observed]
    restart = np.zeros(n, dtype=np.int64)
    restart[0] = 2
    travel = angle[:, None] * 1e-3 / (2 * np.pi)
    given = inputs_along(PumpJoint, n)
    course = Course(1e-3, restart, np.arange(n) * 1e-3, travel, observed, np.zeros((n, 1)), given)
    arm = joint.follow(joint.vector(values), course).readings[:, 0]
    # What is left over comes from the pump moving in straight lines between samples.
    assert np.abs(arm - reference[:, 0]).max() < 0.005 * DEGREE
