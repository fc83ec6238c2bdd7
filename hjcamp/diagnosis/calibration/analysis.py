"""An analysis of measured tests of any plant: its windows, its calibrated base, and what it may miss."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.algebra import take_one_thread
from hjcamp.diagnosis.calibration.active_bounds import held_away
from hjcamp.diagnosis.calibration.contact_compliance import with_contact_forms
from hjcamp.diagnosis.calibration.hidden_states import completed_states
from hjcamp.diagnosis.calibration.kinds import with_balances
from hjcamp.diagnosis.calibration.multistart import BEGUN_APART, above_noise, best_begun, in_parts, refitted_from_model_states
from hjcamp.diagnosis.calibration.prediction_windows import predictable, simulated_through
from hjcamp.diagnosis.calibration.window_length import width_of
from hjcamp.diagnosis.candidates.nonparametric_terms import courses_of, possible_laws, ranges_of, unknowns_of
from hjcamp.diagnosis.candidates.visited_range import about_visited
from hjcamp.diagnosis.data.feedthrough import may_be_late
from hjcamp.diagnosis.data.repeatability import NoiseFloor, noise_floor_of
from hjcamp.diagnosis.data.tests import MOST_DELAY, Measured
from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free, settled
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.selection.search import Search
from hjcamp.diagnosis.validation.blocks import blocks_of
from hjcamp.diagnosis.validation.channels import Channels
from hjcamp.errors import UsageError
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.declare.plant import Plant

Array = NDArray[np.float64]
Report = Callable[[str, float], None]
# In samples: how much earlier and later than its log an input may act. One that runs linearly acts half a sample earlier than held; the
# channels of a record are read within a sample.
EARLY = 1.0
# A base parameter is as declared to within so large a factor (one standard deviation), an input as late as logged to within a sample.
DECLARED = 3.0


@dataclass
class Known:
    """What windows of one width told, with which those of another begin: base parameters, and the forms of contacts.

    ``shown`` are the forms that one width has shown: a contact has its form in windows of every length. ``apart`` says whether the
    base was begun from other places than declared.
    """

    base: dict[str, float] = field(default_factory=dict)
    forms: dict[str, dict[str, float]] = field(default_factory=dict)
    shown: set[str] = field(default_factory=set)
    apart: bool = False

    def keeps(self, candidate: Candidate) -> bool:
        """Whether a base that was begun from several places is where they have led it, not half as far off as these were."""
        ratios = [
            candidate.base[name] / value for name, value in self.base.items() if value and not name.startswith((DELAY, ZERO))
        ]
        return self.apart and all(BEGUN_APART**-0.5 < ratio < BEGUN_APART**0.5 for ratio in ratios)


@dataclass(frozen=True)
class Analysis:
    """Windows of the tests with a model to start from, calibrated; where they began before any fit is what the search has as first.

    ``channels`` are what a model is judged by: the sensors' predictions, then balances of measured states."""

    windows: Windows
    search: Search
    start: Candidate
    base: Scored
    noise_floor: NoiseFloor
    channels: Channels

    @property
    def measured(self) -> Measured:
        """The tests."""
        return self.windows.layout.measured

    @cached_property
    def held(self) -> tuple[str, ...]:
        """The base parameters that a bound keeps away from what is declared."""
        return held_away(self.search, self.base)


def calibrated(
    measured: Measured,
    library: Mapping[str, type[Effect]],
    start: Candidate | None = None,
    report: Report = lambda text, share: None,
    seed: int = 1,
    width: int | None = None,
    unknowns: bool = True,
    effort: str = "standard",
    workers: int = 1,
    known: Known | None = None,
    forms: Mapping[str, type[Effect]] | None = None,
    wanted: Iterable[str] = (),
) -> Analysis:
    """Return the analysis of tests with a model's base parameters, and its effects', calibrated on them.

    ``known`` is what windows of another width told; it is brought up to date. Contacts may have the forms among the ``library`` and
    ``forms``; those of ``forms`` alone are not looked for beyond that. ``wanted`` effects are looked at whatever they promise.
    Of logs longer than the ``effort`` allows, runs of windows are looked at that are evenly spread over them.
    """
    take_one_thread()
    known, both = known or Known(), {**library, **(forms or {})}
    unnamed = frozenset(name for name, effect in both.items() if name not in library or not effect.claimed)
    base, free = free_base(measured, start.base if start else {})
    candidate = Candidate({**base, **(start.base if start else {})}, start.effects if start else {})
    kernels = _compiled_ahead(measured.plant, both, unknowns)
    before = candidate.with_base(known.base)
    windows, begun = predictable(measured, kernels, before, free, width or width_of(measured), effort)
    windows = windows if width else simulated_through(windows, Candidate(base, {}), free)
    report("calibrating", 0.1)
    blocks, declared, asked = blocks_of(windows.layout), dict(candidate.base), frozenset(wanted)
    search = Search(
        windows,
        both,
        {},
        blocks,
        free,
        {},
        seed,
        report,
        workers,
        known.forms,
        unnamed=unnamed,
        wanted=asked,
        declared=declared,
    )
    fitted = _best_fit(search, begun, known)
    _admit_laws(search, fitted, unknowns)
    scored = with_contact_forms(search, search.scored(fitted), known.shown)
    known.shown |= set(scored.names) & windows.forms
    known.base = dict(scored.fitted.candidate.base)
    report("balances at measured states", 0.2)
    scored, channels = with_balances(search, scored)
    layout = windows.layout
    return Analysis(
        windows, search, candidate, scored, noise_floor_of(layout, layout.predictions(scored.fitted.features)), channels
    )


def _compiled_ahead(plant: type[Plant], effects: Mapping[str, type[Effect]], unknowns: bool) -> Kernels:
    """Return the kernels of a plant; another process begins with that of all effects, and of what may be unknown."""
    kernels = Kernels(plant, effects, ahead=True)
    kernels.foresee(possible_laws(plant) if unknowns else {})
    kernels.prepare(effects)
    return kernels


def free_base(measured: Measured, start: Mapping[str, float]) -> tuple[dict[str, float], list[Free]]:
    """Return the base as declared, with the delays of inputs and the zeros of counters, and what of it is fitted from ``start``.

    What a log gives is not fitted, nor the delay of an input that never moves.
    """
    plant = measured.plant
    given = {name for test in measured.tests for name, _ in test.given}
    base = {name: plant.parameters[name].default for name in plant.base_parameters if name not in given}
    free = [_free(plant.parameters[name], start.get(name)) for name in base]
    for name in may_be_late(plant):
        if any(np.ptp(test.inputs[:, list(plant.inputs).index(name)]) > 0.0 for test in measured.tests):
            late = MOST_DELAY * measured.period
            free.append(Free("", DELAY + name, measured.period, -EARLY * measured.period, late, spread=measured.period))
            base[DELAY + name] = 0.0
    for sensor, step, noise in zip(measured.sensors, measured.steps, measured.noise, strict=True):
        if step > noise:  # where a counter begins to count is known to a step; noise of a step leaves nothing of it in the mean
            free.append(Free("", ZERO + sensor.field, step, -step, step))
            base[ZERO + sensor.field] = 0.0
    return base, free


def _best_fit(search: Search, begun: Candidate, known: Known) -> Fitted:
    """Return the base fitted from ``begun``, and from further starts where short tests or errors above the noise ask for that.

    The windows of the ``search`` are left with the starts of the best. A model that diverges as declared is refused.
    """
    windows, layout = search.windows, search.windows.layout
    before = windows.starts.copy()
    windows.move_starts(begun)
    search.first = windows.place._replace(starts=before)
    fitted = settled(windows, begun, search.free_of(begun))
    if layout.short or above_noise(layout, fitted.features):
        if layout.short or not known.keeps(fitted.candidate):
            names = layout.measured.plant.base_parameters
            fitted, known.apart = best_begun(windows, begun, fitted, names), True
        fitted = refitted_from_model_states(windows, fitted)
    fitted = in_parts(windows, fitted)
    if not np.isfinite(fitted.loss):
        raise UsageError(
            f"plant {layout.measured.plant.name}: the model diverges on these tests with its parameters as declared; "
            "check their values and the units of the logs"
        )
    return fitted


# Places of a state that are kept of where the tests have been.
MOST_VISITS = 4000


def _admit_laws(search: Search, fitted: Fitted, unknowns: bool) -> None:
    """Give the ``search`` the ranges that the tests visit: for the bounds of its effects, and the knots of non-parametric terms."""
    layout, plant = search.windows.layout, search.windows.layout.measured.plant
    states = completed_states(search.windows, fitted.candidate)
    courses = courses_of(plant, fitted.candidate.base, states, layout.inputs, layout.time)
    search.ranges = ranges_of(courses, layout.time)
    some = slice(None, None, max(len(states) // MOST_VISITS, 1))
    search.seen_along = courses | {name: states[some, k] for k, name in enumerate(plant.states)} | {"time": layout.time[some]}
    search.library = {name: about_visited(effect, plant, search.ranges) for name, effect in search.library.items()}
    search.windows.spare(fitted.candidate)
    search.admit(unknowns_of(plant, search.ranges, courses) | search.values() if unknowns else {})


def _free(item: object, value: float | None) -> Free:
    assert isinstance(item, Parameter)
    low, high = item.bounds
    now = item.default if value is None else value
    log = item.default > 0.0 and low > 0.0
    scale = abs(now) or abs(item.default) or 1.0
    spread = math.log(DECLARED) if log else DECLARED * abs(item.default) or math.inf
    return Free("", item.name, scale, low, high, log, spread, item.default)
