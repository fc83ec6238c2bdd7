"""Compile the kernels that everyday work needs, once, so that the first run and the first diagnosis start at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from hjcamp.campaign.plan.planning import composed_plan
from hjcamp.children import safe_children
from hjcamp.configuration.composer import Composer
from hjcamp.effects import load_effects
from hjcamp.model.compile.kernel import LEVELS, shared_source
from hjcamp.model.compile.kernel_cache import is_compiled, load_kernel
from hjcamp.model.compile.shared import SPACE
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.course import Course
from hjcamp.model.declare.effect import Effect
from hjcamp.model.run.inputs_along import inputs_along
from hjcamp.model.run.simulator import PERIOD
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.design.menu import Choice, menu
from hjcamp.plants.pump_joint.diagnosis.design.trials import Bench
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import simulator
from hjcamp.plants.pump_joint.diagnosis.residuals.kernel_choice import first_needed
from hjcamp.plants.pump_joint.diagnosis.residuals.passes import compile_passes
from hjcamp.plants.pump_joint.simulation import run_test

SAMPLES = 20
# One for each text of a kernel: both controllers share theirs, and the first has that of the feedforward besides.
CONDITIONS: tuple[Sequence[str], ...] = (
    ("controller=ffwd_pid",),
    ("controller=pid", "payload=brass_8p5g"),
    ("controller=pid", "payload=brass_8p5g", "orientation=vertical"),
)
Task = tuple[str, Callable[..., None], tuple[object, ...]]


def warm(soon: bool = False) -> Iterator[tuple[str, float]]:
    """Compile and run every kernel of the demo, a diagnosis and `hjcamp next`, side by side on the processors there are.

    Yields what was made ready, and the seconds that it took. The longest come first, where it is needed ``soon`` those of a
    diagnosis.
    """
    yield from side_by_side(sorted(tasks(), key=lambda task: not task[0].startswith("diagnose")) if soon else tasks())


def side_by_side(work: Sequence[Task], workers: int = 0) -> Iterator[tuple[str, float]]:
    """Do the tasks in ``workers`` processes, as many as there are processors by default; yields what and the seconds."""
    from joblib import Parallel, cpu_count, delayed

    # Every kernel holds what this one does: it is compiled here, not once in each process.
    shared = load_kernel(shared_source())
    shared.propagators(PERIOD, LEVELS, 4, np.zeros((SPACE, 16)), np.zeros((LEVELS + 1, 48)), 0)
    with safe_children():
        yield from Parallel(min(workers or cpu_count(), len(work)), return_as="generator_unordered", batch_size=1)(
            delayed(timed)(*task) for task in work
        )


def tasks() -> list[Task]:
    """Return what there is to compile, the longest first: what it is in words, and the call that compiles it."""
    library = tuple(load_effects().values())
    found: list[Task] = [
        (f"next, {len(library)} effects under {controller}", try_test, (choice,)) for controller, choice in menu_tests().items()
    ]
    found += [task for task, _ in _of_a_diagnosis(library)]
    found += [("diagnose, residuals of the views", compile_passes, ()), ("plan, every campaign", plan_campaigns, ())]
    return found + [("run " + " ".join(overrides), run_once, (overrides,)) for overrides in CONDITIONS]


def missing(effects: tuple[type[Effect], ...]) -> list[Task]:
    """Return what a diagnosis with these effects has to compile first, the longest first; nothing where all is there."""
    return [task for task, source in _of_a_diagnosis(effects) if not is_compiled(source)]


def _of_a_diagnosis(effects: tuple[type[Effect], ...]) -> list[tuple[Task, str]]:
    found = []
    for chosen in sorted(first_needed(effects), key=len, reverse=True):
        words = ", ".join(effect.name for effect in chosen) if 0 < len(chosen) < 4 else f"{len(chosen) or 'no'} effects"
        for cut in (cut.name for cut in PumpJoint.cuts if cut.driven):
            names = tuple(effect.name for effect in chosen)
            task: Task = (f"diagnose, {words} driven at {cut}", follow_nothing, (cut, names))
            found.append((task, simulator(chosen, cut).source))
    return found


def timed(subject: str, call: Callable[..., None], given: Sequence[object]) -> tuple[str, float]:
    """Make the call; return ``subject`` and the seconds."""
    begin = time.perf_counter()
    call(*given)
    return subject, time.perf_counter() - begin


def plan_campaigns() -> None:
    """Plan the campaigns that come along: what they are composed of is kept for the plans to come."""
    composer = Composer()
    for name in composer.options("campaign"):
        composed_plan([f"campaign={name}"], composer)


def run_once(overrides: Sequence[str]) -> None:
    """Simulate one test of a configuration."""
    run_test(configured(Composer(), overrides), 1)


def configured(composer: Composer, overrides: Sequence[str]) -> dict[str, Any]:
    """Return the configuration of a test as the plan of a run has it: with the model that the controller calculates with."""
    config = composer.compose(overrides).config
    config["controller_model"] = composer.model(str(config["controller"].get("model")))
    return config


def menu_tests() -> dict[str, Choice]:
    """Return a test of the menu of `hjcamp next` for each controller: every effect is in one kernel."""
    return {str(choice.settings["controller"]): choice for choice in menu()}


def try_test(choice: Choice) -> None:
    """Simulate one test as `hjcamp next` does, with every effect of the library in the model and none of them present."""
    bench = Bench(tuple(load_effects().values()))
    trial = bench.trial(choice)
    if trial is not None:
        bench.columns(trial, Candidate({}), 1)


def follow_nothing(cut: str, names: Sequence[str]) -> None:
    """Drive the model of a cut along a few samples in which nothing moves: that compiles what a diagnosis runs."""
    library = load_effects()
    model = simulator(tuple(library[name] for name in names), cut)
    composition = model.composition
    course = Course(
        period=1e-3,
        restart=np.array([2] + [0] * (SAMPLES - 1)),
        time=np.linspace(0.0, 1e-3 * SAMPLES, SAMPLES, endpoint=False, dtype=np.float64),
        driven=np.zeros((SAMPLES, len(composition.cut.driven))),
        observed=np.zeros((SAMPLES, len(composition.observed))),
        velocity=np.zeros((SAMPLES, len(composition.contacts))),
        given=inputs_along(composition.plant, SAMPLES),
    )
    model.follow(model.vector({}), course)


def ready_to_diagnose(effects: Sequence[str]) -> None:
    """Load what a diagnosis with the named effects runs, as far as it is compiled: who asks compiles the rest meanwhile."""
    library = load_effects()
    for (_, call, given), source in _of_a_diagnosis(tuple(library[name] for name in effects)):
        if is_compiled(source):
            call(*given)
    compile_passes()
