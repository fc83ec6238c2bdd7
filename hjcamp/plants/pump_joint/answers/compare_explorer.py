"""A comparison as the explorer shows it: every test, what was measured and what each model says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.diagnosis.compare import Comparison
    from hjcamp.plants.pump_joint.diagnosis.residuals.replay import Replay
    from hjcamp.records.views.model_log import ModelledTest
    from hjcamp.report.pages.exploration import Exploration


def exploration_of(found: Comparison) -> Exploration:
    """Return every test with all logged channels, all models, and each model without one of its effects (off at first)."""
    from hjcamp.records.log import observed
    from hjcamp.report.pages.exploration import Exploration

    replays = _replays(found)
    noise_floors = {name: error.noise_floor for name, error in replays[0].errors.items() if error}
    names = [one.name for one in (*replays, *found.lesser)]
    tests = replays[0].evidence.tests
    word = observed(test.log for test in tests)
    shown = Exploration(len(tests), names, noise_floors, [one.name for one in found.lesser], word)
    for test in tests_of(found):
        shown.add(test.name, test.condition, test.time, test.measured, test.models)
    return shown


def _replays(found: Comparison) -> list[Replay]:
    return [one.replay for one in (*found.models, *([found.calibrated] if found.calibrated else []))]


def tests_of(found: Comparison) -> Iterator[ModelledTest]:
    """Yield every test with what was measured and what each model says, in the units of the fields."""
    from hjcamp.plants.pump_joint.diagnosis.measured.signals import STRIDE
    from hjcamp.plants.pump_joint.diagnosis.residuals.replay import CHANNELS
    from hjcamp.records.views.model_log import ModelledTest
    from hjcamp.report.pages.exploration import NOT_CHANNELS, names_of

    replays = _replays(found)
    evidence = replays[0].evidence
    names = names_of([test.log for test in evidence.tests])
    for index, test in enumerate(evidence.tests):
        part = slice(int(evidence.edges[index]), int(evidence.edges[index + 1]))
        columns = {name: values[::STRIDE] for name, values in test.log.command_phase.items() if name not in NOT_CHANNELS}
        measured = {name: replays[0].measured[part, place] for place, name in enumerate(CHANNELS[:3])}
        models = {}
        for one in (*replays, *found.lesser):
            models[one.name] = {name: one.predicted[part, place] for place, name in enumerate(CHANNELS[:3])}
            if index in one.pump:
                measured[CHANNELS[3]] = one.pump_measured[index][::STRIDE]
                models[one.name][CHANNELS[3]] = measured[CHANNELS[3]] + one.pump[index][::STRIDE]
        further = {name: values for name, values in columns.items() if name not in measured}
        yield ModelledTest(names[index], test.condition, test.time, {**measured, **further}, models, test.log.metadata)
