"""The tests that separate what a diagnosis of any plant leaves, as configurations of the campaign that is at work."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.analyses.data import Data, Report
from hjcamp.backends.plant_simulation import plant_in
from hjcamp.backends.rig.any_plant.backend import follows
from hjcamp.commands.hunting.chosen import Choose, Chosen, condition_name, plan_of
from hjcamp.controllers.fit import controlled_field
from hjcamp.errors import UsageError, counted
from hjcamp.model.language.field_unit import unit_of_field

if TYPE_CHECKING:
    from hjcamp.analyses.diagnosing import Asked, PlantDiagnosed
    from hjcamp.analyses.proposing import PlantProposed
    from hjcamp.diagnosis.design.wanted import Wanted

Array = NDArray[np.float64]
Config = Mapping[str, Any]
#: Values of a course at most: a spline goes through them.
MOST_VALUES = 1000
DIGITS = 9


def judged(data: Data, asked: Asked, report: Report) -> tuple[dict[str, Any], Choose]:
    """Return the diagnosis of tests of any plant, and what chooses the tests that follow it."""
    from hjcamp.analyses.diagnosing import diagnose_plant

    done = diagnose_plant(data, asked, report)
    return done.content, partial(choose, done, asked.seed)


def choose(done: PlantDiagnosed, seed: int, configs: Sequence[Config], tests: int, number: int, report: Report) -> Chosen:
    """Return the tests of `hjcamp next` that can be made as the campaign makes its own, within the limits that hold for them."""
    from hjcamp.analyses.proposing import propose_after
    from hjcamp.commands.any_plant.next_answer import answer

    config, able = next((one for one in configs if follows(one)), configs[0]), Makeable(done, configs)
    beyond: dict[str, str] = {}
    while True:
        proposed = propose_after(
            done, (), tests, seed, report, lambda one, by_motion: one.name not in beyond and able(one, by_motion)
        )
        proposal = proposed.proposal
        rivals = proposal.question.rivals
        said = answer(proposed, None, None, 0.0)
        hidden = tuple(one.name for one in rivals if not one.fitted)
        if not proposal.chosen:
            return Chosen(said, hidden=hidden, why=_why(proposed, able, beyond))
        library = done.analysis.search.library
        models = [one.candidate for one in rivals if one.fitted and all(name in library for name in one.candidate.effects)]
        found: dict[str, dict[str, Any]] = {}
        texts: dict[str, str] = {}
        for place, one in enumerate(proposal.tests):
            made = motion_config(config, done, one.wanted) if proposal.by_motion else course_config(config, proposed, one)
            if reason := _reason(made, models):
                beyond[one.wanted.name] = reason
            elif place < proposal.chosen:
                name = condition_name(one.wanted.name, number, found)
                found[name], texts[name] = made, one.wanted.text
        if found:
            return Chosen(said, found, texts, max(proposal.tests[0].repetitions, 1), hidden)


def _reason(config: Config, models: Sequence[Any]) -> str:
    from hjcamp.commands.hunting.limits import beyond_limits

    try:
        plan_of("test", "", {"test": config}, 1, 1)
    except UsageError as problem:
        return str(problem)
    return beyond_limits(config, models)


class Makeable:
    """Whether a test of the menu can be made as a campaign makes its own; ``excluded`` says why others cannot, by name."""

    def __init__(self, done: PlantDiagnosed, configs: Sequence[Config]) -> None:
        self._measured = done.analysis.measured
        self._follows = any(follows(one) for one in configs)
        self._starts_anywhere = configs[0]["backend"]["name"] == "simulation"
        self.excluded: dict[str, str] = {}

    def __call__(self, wanted: Wanted, by_motion: bool) -> bool:
        """Return whether the campaign's own loop, or a given input, makes this test and nothing has to be mounted for it."""
        reason = self._reason(wanted, by_motion)
        if reason:
            self.excluded[wanted.name] = reason
        return not reason

    def _reason(self, wanted: Wanted, by_motion: bool) -> str:
        if wanted.given != self._measured.tests[wanted.of].given:
            return "something would have to be mounted"
        if by_motion:
            return (
                ""
                if self._follows
                else "they are motions, and no controller of the campaign follows one (controller=plain_pid does)"
            )
        names = [name for name in self._measured.plant.inputs if name not in ("time", "direction")]
        defaults = [self._measured.plant.inputs[name].default for name in names]
        others = [k for k, name in enumerate(names) if name != wanted.driven]
        if not wanted.pieces or any(np.any(wanted.inputs[:, k] != defaults[k]) for k in others):
            return "they are no course of one input alone"
        if not self._starts_anywhere and (wanted.start_at or wanted.begun != 1.0):
            return "they begin where this rig does not"
        return ""


def _why(proposed: PlantProposed, able: Makeable, beyond: Mapping[str, str]) -> str:
    """Say why no test is chosen."""
    proposal = proposed.proposal
    if len(proposal.question.rivals) < 2:
        return "no rivals remain"
    reasons = Counter(able.excluded.values())
    left_out = [f"{counted(count, 'test')} left out: {reason}" for reason, count in reasons.items()]
    left_out += [f"left out for a limit: {name}: {reason}" for name, reason in list(beyond.items())[:3]]
    best = (
        f"; the best of {proposal.tried} separates one pair by {proposal.best:.1f} standard deviations"
        if proposal.tests
        else ""
    )
    return "; ".join([f"no test within the limits separates what remains{best}", *left_out])


def motion_config(config: Config, done: PlantDiagnosed, wanted: Wanted) -> dict[str, Any]:
    """Return the configuration in which the campaign's controller follows a wanted motion, from its usual start and back to it."""
    plant = plant_in(config)
    field, measured = controlled_field(plant), done.analysis.measured
    column = [one.field for one in measured.sensors].index(field)
    path = from_start_and_back(wanted.readings[:, column], plant.period)
    stride = max(math.ceil(len(path) / MOST_VALUES), 1)
    unit = unit_of_field(field, f"plant {plant.name}")
    values = [0.0, *(float(f"{value * unit.scale:.{DIGITS}g}") for value in path[stride::stride]), 0.0]
    curve = {"name": "curve", "kind": "curve", f"values_{unit.suffix}": values, "step_time": stride * plant.period}
    return {**config, "trajectory": curve}


def from_start_and_back(path: Array, period: float) -> Array:
    """Return a path (n,) with the ways from 0 to its begin and from its end to 0 added, no faster than it is itself."""
    speed = float(np.max(np.abs(np.diff(path)), initial=0.0)) / period
    change = float(np.percentile(np.abs(np.diff(path, 2)), 99.0)) / period**2 if len(path) > 2 else 0.0

    def way(size: float) -> Array:
        if size == 0.0 or speed == 0.0:
            return np.zeros(0)
        # a cycloid is at most twice as fast as on average
        times = [2.0 * abs(size) / speed, math.sqrt(2.0 * math.pi * abs(size) / change) if change > 0.0 else 0.0, 5.0 * period]
        share = np.arange(math.ceil(max(times) / period)) / math.ceil(max(times) / period)
        return np.asarray(size * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi)))

    return np.concatenate([way(float(path[0])), path, way(float(path[-1]))[::-1]])


def course_config(config: Config, proposed: PlantProposed, one: Any) -> dict[str, Any]:
    """Return the configuration in which one input is given and all others rest."""
    from hjcamp.commands.any_plant.next_campaign import settings_of
    from hjcamp.configuration.composer import Composer

    plant, settings = plant_in(config), settings_of(proposed, one)
    lines = [f"plant={plant.name}", "controller=given", f"controller.input={one.wanted.driven}", "trajectory=segments"]
    law = Composer().compose(lines).config["controller"]
    starts = {key.removeprefix("start."): value for key, value in settings.items() if key.startswith("start.")}
    simulated = config["backend"]["name"] == "simulation"
    found = {**config, "controller": law}
    found["trajectory"] = {"name": "segments", "kind": "segments", "segments": settings["trajectory.segments"]}
    return {**found, "start": {**(config.get("start") or {}), **starts}} if simulated else found
