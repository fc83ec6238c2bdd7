"""Figures of the configured joint: the three elements of its friction, and the load of its payload over the arm's angle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.figures.sizing import Figures
from hjcamp.plants.pump_joint.sizing.tubing import weight_at_sliders
from hjcamp.report.pictures.conditions import BLUE, INK, RED
from hjcamp.report.pictures.drawing import dress

Array = NDArray[np.float64]
DASHED = (0, (4, 2.5))
FASTEST = 80e-3  # m/s at the sliders: 1280 deg/s of the arm, the fastest of the friction tests
ANGLES_DEG = (-120.0, 120.0)  # thesis 4.6.1


def figures_of(config: Mapping[str, Any]) -> Figures:
    """Return the figures of a resolved configuration: file name to (size in inches, what draws it)."""
    return {
        "figure_4_5_2": ((6.4, 4.4), partial(friction_elements, config=config)),
        "figure_5_5_9": ((6.4, 4.4), partial(payload_load, config=config)),
    }


def friction_elements(figure: Any, config: Mapping[str, Any]) -> None:
    """Figure 4.5.2: static, Coulomb and viscous friction of the configured joint over the speed of its sliders."""
    axes = figure.subplots()
    for sign, side, colour in ((1.0, "positive", BLUE), (-1.0, "negative", RED)):
        one = config["friction"][side]
        static, coulomb, viscous = (float(one[name]) for name in ("static_n", "coulomb_n", "viscous_ns_per_mm"))
        speed = np.linspace(0.0, FASTEST, 2)
        force = coulomb + viscous * 1e3 * speed
        label = f"{side}: static {static:g} N, Coulomb {coulomb:g} N, viscous {viscous * 1e3:g} N s/m"
        axes.plot(sign * speed * 1e3, sign * force, color=colour, label=label)
        axes.plot([0.0, 0.0], [0.0, sign * static], color=colour, linewidth=2.2)
        axes.plot([0.0], [sign * static], color=colour, marker="o", markersize=4.5)
        axes.annotate("static", (0.0, sign * static), (8 * sign, 0), textcoords="offset points", fontsize=7.5,
                      ha="left" if sign > 0 else "right", va="center")  # fmt: skip
        axes.annotate("Coulomb", (0.0, sign * coulomb), (8 * sign, -7 * sign), textcoords="offset points", fontsize=7.5,
                      ha="left" if sign > 0 else "right", va="center")  # fmt: skip
    axes.axhline(0.0, color=INK, linewidth=0.6)
    dress(axes, "Friction at the sliders (N)")
    axes.legend(fontsize=8, frameon=False, loc="upper left")
    axes.set_ylim(top=1.15 * axes.get_ylim()[1])
    axes.set_xlabel(f"Speed of the sliders (mm/s); friction={config['friction']['name']}", fontsize=8.5)


def payload_load(figure: Any, config: Mapping[str, Any]) -> None:
    """Figure 5.5.9: the force at the sliders by which the configured payload pulls on a vertical arm, over its angle."""
    axes = figure.subplots()
    largest, rest = largest_load(config)
    angle = np.linspace(*ANGLES_DEG, 241)
    axes.plot(angle, load_over_angle(np.radians(angle), largest, rest), color=BLUE)
    for level in (-largest, largest):
        axes.axhline(level, color=INK, linewidth=0.6, linestyle=DASHED)
    axes.annotate(f"{largest:.2f} N", (ANGLES_DEG[0], largest), (2, 3), textcoords="offset points", fontsize=7.5)
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.margins(y=0.15)
    if not largest:  # the rounding of zeros is no scale
        axes.set_ylim(-0.1, 0.1)  # N
    dress(axes, "Force at the sliders (N)")
    payload = config["payload"]
    what = (
        f"{float(payload['mass_g']):g} g at {float(payload['radius_mm']):g} mm, vertical; hangs at {math.degrees(rest):g} deg"
    )
    axes.set_xlabel(f"Angle of the arm (deg); payload={payload['name']}, {what}", fontsize=8.5)


def load_over_angle(angle: Array, largest: float, rest: float) -> Array:
    """Return -F sin(theta - theta_0), N, at angles in rad. Source: thesis 5.5, Figure 5.5.9."""
    return np.asarray(-largest * np.sin(angle - rest))


def largest_load(config: Mapping[str, Any]) -> tuple[float, float]:
    """Return the largest force of the configured payload at the sliders, N, and the angle at which it hangs, rad."""
    payload, radius = config["payload"], 0.5e-3 * float(config["joint"]["pulley_pitch_diameter_mm"])
    weight = ((config.get("effects") or {}).get("gravity_load") or {}).get("rest_angle", 0.0)
    load = weight_at_sliders(float(payload["mass_g"]) * 1e-3, float(payload["radius_mm"]) * 1e-3, radius)
    return load, float(weight)
