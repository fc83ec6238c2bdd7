"""Compile the kernels that everyday work needs, once, so that the first run and the first diagnosis start at once."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

import numpy as np

from hjcamp.backends.simulation import run_test
from hjcamp.configuration.composer import Composer
from hjcamp.discrepancy.hardware import simulator
from hjcamp.effects import load_effects
from hjcamp.model.simulator import Course, Simulator
from hjcamp.plants.pump_joint import PumpJoint

SAMPLES = 20
CONDITIONS: tuple[Sequence[str], ...] = (
    ("controller=pid",),
    ("controller=ffwd_pid",),
    ("controller=pid", "payload=brass_8p5g"),
    ("controller=ffwd_pid", "payload=brass_8p5g"),
    ("controller=pid", "payload=brass_8p5g", "orientation=vertical"),
    ("controller=ffwd_pid", "payload=brass_8p5g", "orientation=vertical"),
)


def warm() -> Iterator[tuple[str, float]]:
    """Compile and run every kernel of the demo and of a diagnosis; yield what was made ready, and the seconds."""
    composer = Composer()
    for overrides in CONDITIONS:
        begin = time.perf_counter()
        config = composer.compose(overrides).config
        # The plan of a run adds the model that the controller calculates with.
        config["controller_model"] = composer.model(str(config["controller"].get("model")))
        run_test(config, 1)
        yield "run " + " ".join(overrides), time.perf_counter() - begin
    library = tuple(load_effects().values())
    for cut in [cut.name for cut in PumpJoint.cuts if cut.driven]:
        begin = time.perf_counter()
        follow_nothing(simulator(library, cut))
        yield f"diagnose, {len(library)} effects driven at {cut}", time.perf_counter() - begin


def follow_nothing(model: Simulator) -> None:
    """Drive ``model`` along a few samples in which nothing moves: what is compiled here is what a diagnosis runs."""
    composition = model.composition
    start = np.zeros(SAMPLES)
    course = Course(
        period=1e-3,
        restart=np.array([2] + [0] * (SAMPLES - 1)),
        time=np.linspace(0.0, 1e-3 * SAMPLES, SAMPLES, endpoint=False, dtype=np.float64),
        driven=np.zeros((SAMPLES, len(composition.cut.driven))),
        observed=np.zeros((SAMPLES, len(composition.plant.observed))),
        velocity=start,
        dither=start,
        scatter=np.ones(SAMPLES),
    )
    model.follow(model.vector({}), course)
