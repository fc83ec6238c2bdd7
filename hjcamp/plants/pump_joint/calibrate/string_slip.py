"""Whether a test asks for more torque than the string can carry to the pulley."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hjcamp.plants.pump_joint.sizing.pulley import largest_torque
from hjcamp.plants.pump_joint.sizing.tubing import GRAVITY
from hjcamp.trajectories import build_trajectory

SAMPLES_PER_S = 1000
# The moving parts that turn with the pulley, pulley 9.1 and arm 51.6 g mm^2 (thesis 4.5.2).
ROTATING_INERTIA = 60.7e-9


def string_warning(config: Mapping[str, Any]) -> str | None:
    """Return what to say where the motion and weight of a test's arm would slip its string, else None.

    .. math:: M = J \\max|\\ddot\\theta| + m g r > T_1 (e^{\\mu\\beta} - 1) r_p

    with T_1 = ``joint.string.minimum_tension_n``. ``config`` is the resolved configuration of one condition. The arm's
    steps (an acceleration without bound) count by their gravity alone. Source: thesis 3.6.2, 3.6.3.
    """
    joint, payload = config["joint"], config["payload"]
    string = joint.get("string")
    if not string:
        return None
    mass, radius = payload["mass_g"] * 1e-3, payload["radius_mm"] * 1e-3
    trajectory = build_trajectory(config["trajectory"])
    time = np.arange(round(trajectory.duration * SAMPLES_PER_S)) / SAMPLES_PER_S
    acceleration = float(np.max(np.abs(trajectory.reference(time)[2]), initial=0.0))
    gravity = mass * GRAVITY * radius if "gravity_load" in (config.get("effects") or {}) else 0.0
    torque = (ROTATING_INERTIA + mass * radius**2) * acceleration + gravity
    limit = largest_torque(
        string["minimum_tension_n"],
        string["turns"],
        string["friction_coefficient"],
        joint["pulley_pitch_diameter_mm"] * 0.5e-3,
    )
    if torque <= limit:
        return None
    return (
        f"the arm needs up to {torque * 1e3:.3g} mNm, but at {string['minimum_tension_n']:g} N of tension the string "
        f"slips on the pulley above {limit * 1e3:.3g} mNm (thesis 3.6.3)"
    )
