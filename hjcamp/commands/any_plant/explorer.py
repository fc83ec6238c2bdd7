"""A comparison of any plant as the explorer and viewers show it: every test, every channel, what each model predicts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hjcamp.analyses.plant_comparison import PlantComparison
    from hjcamp.diagnosis.data.segments import Layout
    from hjcamp.diagnosis.results.comparison import Shown
    from hjcamp.records.log import TestLog
    from hjcamp.records.views.model_log import ModelledTest
    from hjcamp.report.pages.exploration import Exploration


def exploration_of(found: PlantComparison) -> Exploration:
    """Return every test with all logged channels, all models, and each model without one of its effects (off at first)."""
    from hjcamp.records.log import observed
    from hjcamp.report.pages.exploration import Exploration

    layout = found.analysis.windows.layout
    tests, sensors = layout.measured.tests, layout.measured.sensors
    noise_floor = found.analysis.noise_floor.of_sensors(layout)
    noise_floors = {one.field: float(noise_floor[k] * one.scale) for k, one in enumerate(sensors)}
    models, lesser = _models(found), [one.name for one in found.lesser]
    word = observed(test.log for test in tests)
    shown = Exploration(len(tests), [one.name for one in models], noise_floors, lesser, word)
    for place, test in enumerate(modelled_tests(found)):
        errors = {one.name: {s.field: float(one.by_test[place, k] * s.scale) for k, s in enumerate(sensors)} for one in models}
        shown.add(test.name, test.condition, test.time, test.measured, test.models, errors)
    return shown


def modelled_tests(found: PlantComparison) -> Iterator[ModelledTest]:
    """Yield every test with all that was logged and what each model predicts over windows, in the units of the fields.

    Predictions are NaN where a test belongs to no window that is looked at.
    """
    from hjcamp.records.views.model_log import ModelledTest
    from hjcamp.report.pages.exploration import names_of

    layout = found.analysis.windows.layout
    names = names_of([test.log for test in layout.measured.tests])
    for place, test in enumerate(layout.measured.tests):
        models = {one.name: _predicted(layout, place, one) for one in _models(found)}
        time = test.log.command_phase["time_s"]
        yield ModelledTest(names[place], test.condition, time - time[0], _logged(test.log), models, test.log.metadata)


def _models(found: PlantComparison) -> tuple[Shown, ...]:
    return (*found.models, found.calibrated, *found.lesser)


def _predicted(layout: Layout, place: int, one: Shown) -> dict[str, Any]:
    """Return what a model predicts of one test by field (samples,)."""
    rows = np.flatnonzero(np.repeat(layout.of_test, layout.width) == place)
    test = layout.measured.tests[place]
    begins = len(test.earlier) + layout.width * np.flatnonzero(layout.of_each[place])
    at = (begins[:, None] + np.arange(layout.width)).ravel()
    found = {}
    for k, sensor in enumerate(layout.measured.sensors):
        found[sensor.field] = np.full(len(test.earlier) + test.samples, np.nan)
        found[sensor.field][at] = (layout.readings[rows, k] - one.errors[rows, k]) * sensor.scale
    return found


def _logged(log: TestLog) -> dict[str, Any]:
    """Return the channels of a log whose names say their unit: others have no axis."""
    from hjcamp.model.language.field_unit import unit_of_field
    from hjcamp.report.pages.exploration import NOT_CHANNELS

    found = {}
    for name, values in log.command_phase.items():
        if name in NOT_CHANNELS:
            continue
        try:
            unit_of_field(name, "a log")
        except UsageError:
            continue
        found[name] = values
    return found
