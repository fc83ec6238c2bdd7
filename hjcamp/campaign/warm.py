"""Compile the kernels that everyday work needs, once, so that the first run and the first diagnosis start at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from hjcamp.backends.simulation import run_test
from hjcamp.configuration.composer import Composer
from hjcamp.discrepancy.candidate import Candidate
from hjcamp.discrepancy.hardware import simulator
from hjcamp.discrepancy.next_menu import Choice, menu
from hjcamp.discrepancy.next_trials import Bench
from hjcamp.discrepancy.passes import compile_passes
from hjcamp.effects import load_effects
from hjcamp.model.kernel_cache import is_compiled
from hjcamp.model.simulator import Course
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
Task = tuple[str, Callable[..., None], tuple[object, ...]]


def warm() -> Iterator[tuple[str, float]]:
    """Compile and run every kernel of the demo, a diagnosis and `hjcamp next`, side by side on the processors there are.

    Yields what was made ready, and the seconds that it took.
    """
    from joblib import Parallel, cpu_count, delayed

    work = tasks()
    yield from Parallel(n_jobs=min(cpu_count(), len(work)), return_as="generator_unordered", batch_size=1)(
        delayed(timed)(*task) for task in work
    )


def tasks() -> list[Task]:
    """Return what there is to compile, the longest first: what it is in words, and the call that compiles it."""
    many = len(load_effects())
    cuts = [cut.name for cut in PumpJoint.cuts if cut.driven]
    found: list[Task] = [
        (f"next, {many} effects under {controller}", try_test, (choice,)) for controller, choice in menu_tests().items()
    ]
    found += [(f"diagnose, {many} effects driven at {cut}", follow_nothing, (cut, True)) for cut in cuts]
    found += [(f"diagnose, no effect driven at {cut}", follow_nothing, (cut, False)) for cut in cuts]
    found += [("diagnose, residuals of the views", compile_passes, ())]
    return found + [("run " + " ".join(overrides), run_once, (overrides,)) for overrides in CONDITIONS]


def timed(subject: str, call: Callable[..., None], given: Sequence[object]) -> tuple[str, float]:
    """Make the call; return ``subject`` and the seconds."""
    begin = time.perf_counter()
    call(*given)
    return subject, time.perf_counter() - begin


def run_once(overrides: Sequence[str]) -> None:
    """Simulate one test of a configuration."""
    composer = Composer()
    config = composer.compose(overrides).config
    # The plan of a run adds the model that the controller calculates with.
    config["controller_model"] = composer.model(str(config["controller"].get("model")))
    run_test(config, 1)


def menu_tests() -> dict[str, Choice]:
    """Return a test of the menu of `hjcamp next` for each controller: every effect is in one kernel."""
    return {str(choice.settings["controller"]): choice for choice in menu()}


def try_test(choice: Choice) -> None:
    """Simulate one test as `hjcamp next` does, with every effect of the library in the model and none of them present."""
    bench = Bench(tuple(load_effects().values()))
    trial = bench.trial(choice)
    if trial is not None:
        bench.columns(trial, Candidate({}), 1)


def follow_nothing(cut: str, with_effects: bool) -> None:
    """Drive the model of a cut along a few samples in which nothing moves: that compiles what a diagnosis runs."""
    model = simulator(tuple(load_effects().values()) if with_effects else (), cut)
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


def is_warm() -> bool:
    """Return whether the largest kernel of a diagnosis has been compiled: processes that compile it all at once gain nothing."""
    return is_compiled(simulator(tuple(load_effects().values()), "pump").source)


def ready_to_diagnose() -> None:
    """Load what a diagnosis runs."""
    for cut in PumpJoint.cuts:
        if cut.driven:
            follow_nothing(cut.name, False)
            follow_nothing(cut.name, True)
    compile_passes()
