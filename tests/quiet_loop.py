"""Simulated tests without noise, scatter or counts, of any reference: what hand calculations can be compared with."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.controllers.controller import Controller
from hjcamp.effects import find_effect
from hjcamp.model.compile.compose import Composition
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.controllers.open_loop import OpenLoop
from hjcamp.plants.pump_joint.loop import ClosedLoop, JointSimulator
from hjcamp.plants.pump_joint.procedure import Procedure

Array = NDArray[np.float64]
DEGREE = np.pi / 180
AREA1 = np.pi / 4 * 6.35e-3**2
AREA2 = np.pi / 4 * 4e-3**2
RADIUS = 3.41e-3
STIFFNESS = 0.0257e15
#: Numerator of (4.3.4) in m/rad; the plant's own default is rounded.
EXACT = {"pump_gain": 6.125 / DEGREE}


@cache
def simulator(law: type[Controller] = OpenLoop, effects: tuple[str, ...] = ()) -> JointSimulator:
    """Return one simulator for each law and set of effects, so that its kernel is loaded once."""
    chosen = tuple(find_effect(name) for name in sorted(effects))
    return JointSimulator(Composition(PumpJoint, chosen), controller=law)


def columns(
    reference: Array,
    pressures: tuple[float, float],
    law: type[Controller] = OpenLoop,
    control: Mapping[str, float] | None = None,
    effects: tuple[str, ...] = (),
    values: Mapping[str, float] | None = None,
    count: float = 0.0,
    dither: float = 0.0,
    delay: float = 2e-3,
) -> dict[str, Any]:
    """Return the command phase (SI, by name) of a test that starts at rest at two gauge ``pressures``.

    ``reference`` (n,) or (n, 3): arm angle, velocity, acceleration; for the open loop the pump angle over 8.5.
    """
    rows = np.zeros((len(reference), 4))
    rows[:, : 1 if reference.ndim == 1 else 3] = reference.reshape(len(reference), -1)
    chosen = simulator(law, effects)
    longest = len(rows) + 25000
    wave = np.where((np.arange(len(rows)) // 2) % 2 == 0, dither, -dither)
    test = ClosedLoop(
        control=law.vector(dict(control or {})),
        procedure=Procedure.vector({"first_phase": 2.0, "rest": 0.0, "control": len(rows) * 1e-3}),
        reference=rows,
        dither=wave,
        delay=delay,
        preload_area=AREA1,
        counts=np.array([count, 0.0, 0.0, 0.0]),
        phases=np.full(4, 0.5),
        noise=np.zeros((longest, 4)),
        scatter=np.ones(longest),
    )
    start = {"pressure1": pressures[0], "pressure2": pressures[1]}
    found = chosen.run(start, chosen.vector({**EXACT, **(values or {})}), test)
    during = found["phase"] == 3.0
    return {name: value[during] if np.ndim(value) else value for name, value in found.items()}


def sine(amplitude_deg: float, frequency: float, duration: float) -> Array:
    """Return angle, velocity, acceleration (n, 3) of a sine, rad."""
    w, time = 2 * np.pi * frequency, np.arange(round(duration * 1000)) * 1e-3
    a = amplitude_deg * DEGREE
    return np.column_stack([a * np.sin(w * time), a * w * np.cos(w * time), -a * w * w * np.sin(w * time)])


def cycloid(amplitude_deg: float, duration: float = 2.0) -> Array:
    """Return angle, velocity, acceleration (n, 3) of a cycloidal rise in one second, then rest, rad."""
    time = np.minimum(np.arange(round(duration * 1000)) * 1e-3, 1.0)
    w, a = 2 * np.pi, amplitude_deg * DEGREE
    return np.column_stack([a * (time - np.sin(w * time) / w), a * (1 - np.cos(w * time)), a * w * np.sin(w * time)])
