"""An analysis of measured tests of any plant: its windows, its calibrated base, and what it may miss."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.algebra import take_one_thread
from hjcamp.diagnosis.calibration.active_bounds import held_away
from hjcamp.diagnosis.calibration.contact_compliance import with_contact_forms
from hjcamp.diagnosis.calibration.window_length import width_of
from hjcamp.diagnosis.candidates.nonparametric_terms import courses_of, ranges_of, unknowns_of
from hjcamp.diagnosis.candidates.visited_range import about_visited
from hjcamp.diagnosis.data.feedthrough import may_be_late
from hjcamp.diagnosis.data.repeatability import MOTION_ORDERS, Floor, floor_of, moves, repeatability_of
from hjcamp.diagnosis.data.segments import SHORTEST_OF_ALL, Layout
from hjcamp.diagnosis.data.tests import MOST_DELAY, Measured
from hjcamp.diagnosis.estimation.gauss_newton import SETTLED, TURNS_OF_BASE, Fitted, Free, settled
from hjcamp.diagnosis.levels import LEVEL, MATTERS
from hjcamp.diagnosis.residuals.initial_states import estimated
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.diagnosis.residuals.windows import FARTHEST_MOVED, Windows
from hjcamp.diagnosis.selection.forward import Search
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.blocks import FEWEST, blocks_of
from hjcamp.errors import UsageError
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect

Array = NDArray[np.float64]
Report = Callable[[str, float], None]
# In samples: how much earlier and later than its log an input may act. One that runs linearly acts half a sample earlier than held; the
# channels of a record are read within a sample.
EARLY = 1.0
# Of what a start brings, at the end of a window over that in its first half: a constant jerk makes it 8; more grows by itself.
MOST_GROWTH = 10.0
# Of a plant with few states a start brings no more than a power of the time; what it grows by itself beyond that is less than this.
OWN_GROWTH = math.e
# Of short tests, and where errors are more than noise, the base begins with each parameter so many times smaller and larger, too.
BEGUN_APART = 4.0
# In so many parts samples are simulated.
PARTS = (2, 4)
# Samples that are looked at: time and memory do not grow with the length of the logs.
MOST_SAMPLES = {"quick": 12_000, "standard": 32_000, "thorough": 10_000_000}


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
    """Windows of the tests with a model to start from, calibrated; where they began before any fit is what the search has as first."""

    windows: Windows
    search: Search
    start: Candidate
    base: Scored
    floor: Floor

    @property
    def measured(self) -> Measured:
        """The tests."""
        return self.windows.layout.measured

    @cached_property
    def held(self) -> tuple[str, ...]:
        """The base parameters that a bound keeps away from what is declared."""
        return held_away(self.search, self.base)


def what_lacks(measured: Measured, layout: Layout) -> list[str]:
    """Return in words what these tests lack for a verdict; empty where nothing does."""
    found = []
    blocks = len(np.unique(blocks_of(layout)))
    if blocks < FEWEST or len(layout.of_test) < 3 * FEWEST:
        asked = (
            "repetitions share theirs, so longer tests or tests of other courses"
            if len(layout.of_test) >= 3 * FEWEST and measured.repeated
            else f"longer or more tests (at least {3 * FEWEST * SHORTEST_OF_ALL} samples, these have "
            f"{sum(test.samples for test in measured.tests)}{_before(measured)})"
        )
        found.append(
            f"{len(layout.of_test)} windows of {layout.width * measured.period:.4g} s in {blocks} blocks; "
            f"{3 * FEWEST} windows in {FEWEST} blocks are needed: {asked}"
        )
    if not moves(layout)[: MOTION_ORDERS * len(measured.sensors)].any():
        found.append("nothing that is measured changes in these tests by more than its noise")
    return found


def _before(measured: Measured) -> str:
    """Return in words how many samples of the logs are not looked at, as they tell what inputs were before the tests."""
    lead = sum(len(test.earlier) for test in measured.tests)
    return f" behind {lead} that tell what inputs were before" if lead else ""


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
    plant, known = measured.plant, known or Known()
    both = {**library, **(forms or {})}
    unnamed = frozenset(name for name, effect in both.items() if name not in library or not effect.claimed)
    given = {name for test in measured.tests for name, _ in test.given}
    base = {name: plant.parameters[name].default for name in plant.base_parameters if name not in given}
    free = [_free(plant.parameters[name], (start.base if start else {}).get(name)) for name in base]
    for name in may_be_late(plant):
        if any(np.ptp(test.inputs[:, list(plant.inputs).index(name)]) > 0.0 for test in measured.tests):
            free.append(Free("", DELAY + name, measured.period, -EARLY * measured.period, MOST_DELAY * measured.period))
            base[DELAY + name] = 0.0
    for sensor, step in zip(measured.sensors, measured.steps, strict=True):
        if step > 0.0:  # where a counter begins to count is known to a step
            free.append(Free("", ZERO + sensor.field, step, -step, step))
            base[ZERO + sensor.field] = 0.0
    candidate = Candidate({**base, **(start.base if start else {})}, start.effects if start else {})
    begun = candidate.with_base(known.base)
    kernels = Kernels(plant, both, ahead=workers > 1)
    kernels.prepare(both)
    windows, begun = predictable(measured, kernels, begun, free, width or width_of(measured), effort)
    windows = windows if width else simulated_through(windows, Candidate(base, {}), free)
    layout = windows.layout
    report("calibrating", 0.1)
    search = Search(
        windows,
        both,
        {},
        blocks_of(layout),
        free,
        {},
        seed,
        report,
        workers,
        known.forms,
        unnamed=unnamed,
        wanted=frozenset(wanted),
        declared=dict(candidate.base),
    )  # fmt: skip
    before = windows.starts.copy()
    windows.move_starts(begun)
    search.first = windows.place._replace(starts=before)
    fitted = settled(windows, begun, search.free_of(begun), turns=TURNS_OF_BASE)
    if layout.short or above_noise(layout, fitted.features):
        if layout.short or not known.keeps(fitted.candidate):
            fitted, known.apart = best_begun(windows, begun, fitted, plant.base_parameters), True
        fitted = begun_anew(windows, fitted)
    fitted = in_parts(windows, fitted)
    layout = windows.layout
    if not np.isfinite(fitted.loss):
        raise UsageError(
            f"plant {plant.name}: the model diverges on these tests with its parameters as declared; "
            "check their values and the units of the logs"
        )
    states = _filled(windows, fitted.candidate)
    courses = courses_of(plant, fitted.candidate.base, states, layout.inputs, layout.time)
    search.ranges = ranges_of(courses, layout.time)
    search.library = {name: about_visited(effect, plant, search.ranges) for name, effect in search.library.items()}
    windows.spare(fitted.candidate)
    search.admit(unknowns_of(plant, search.ranges, courses) if unknowns else {})
    scored = search.scored(fitted)
    scored = with_contact_forms(search, scored, known.shown)
    known.shown |= set(scored.names) & windows.forms
    known.base = dict(scored.fitted.candidate.base)
    search.repeatability = repeatability_of(layout, scored.fitted.features)
    return Analysis(windows, search, candidate, scored, floor_of(layout, scored.fitted.features))


def predictable(
    measured: Measured, kernels: Kernels, candidate: Candidate, free: Sequence[Free], width: int, effort: str
) -> tuple[Windows, Candidate]:
    """Return windows of ``width`` samples, or of a half, a quarter, ... where a start grows beyond any prediction in them.

    The model is fitted to the shortest first, and goes on from there: about a path that has left the measured one nothing is
    told, neither of growth nor of parameters.
    """
    widths = [width]
    while widths[0] >= 2 * SHORTEST_OF_ALL:
        widths.insert(0, widths[0] // 2)
    found = _begun(measured, kernels, candidate, widths[0], effort)
    if len(widths) > 1:
        found.move_starts(candidate)
        fitted = settled(found, candidate, free)
        candidate = fitted.candidate if np.isfinite(fitted.loss) else candidate
    order = len(measured.plant.states) - 1
    own = found.growth(candidate) / power_of(widths[0], order) if len(widths) > 1 else 0.0
    for one in widths[1:]:
        longer = _begun(measured, kernels, candidate, one, effort)
        # what grows by itself squares in twice the time, though the path may have left the plant by then and grow no more
        own = max(longer.growth(candidate) / power_of(one, order), own**2)
        if own > min(MOST_GROWTH / power_of(one, order), OWN_GROWTH):
            break
        found = longer
    return found, candidate


def simulated_through(windows: Windows, base: Candidate, free: Sequence[Free]) -> Windows:
    """Return windows of tests that are simulated through, where tests are too short for windows as long as the plant's memory.

    In shorter windows the starts take most of what the plant does. It has to forget a start within a block, and no loop outside
    its equations may hold it. The memory is that of the ``base`` fitted to these windows: one set of logs is looked at in one way,
    whatever model is asked about.
    """
    layout, plant = windows.layout, windows.layout.measured.plant
    if not layout.short or plant.loop == "foreign":
        return windows
    own = replace(windows)
    own.move_starts(base)
    fitted = settled(own, base, free, turns=TURNS_OF_BASE)
    known = best_begun(own, base, fitted, plant.base_parameters).candidate if np.isfinite(fitted.loss) else base
    memory = replace(windows, layout=replace(layout, memory=1)).memory(known)
    if memory <= layout.width or len(layout.of_test) * layout.width < FEWEST * memory:
        return windows
    return replace(windows, layout=replace(layout, memory=memory))


def above_noise(layout: Layout, features: Array) -> bool:
    """Whether features (windows, d) are more than the noise of a sensor by chance: what leaves no more cannot be fitted better."""
    from scipy.special import gammaincinv

    each = features.reshape(len(features), len(layout.measured.sensors), -1)
    # the sum of n squares of noise is chi-squared
    half = 0.5 * each[:, 0].size
    return bool(np.any(np.mean(each**2, axis=(0, 2)) > gammaincinv(half, 1.0 - LEVEL) / half))


def in_parts(windows: Windows, fitted: Fitted) -> Fitted:
    """Return a fit with samples simulated in as many parts as what is given between them asks for; ``windows`` are left so.

    An input that acts a fraction of a sample late, or runs on from sample to sample, is its mean over a sample. Where that differs
    from parts by a tenth of a sensor's noise (rms), and of what a model leaves that takes all that matters, these are simulated.
    """
    if not (windows.layout.ahead or any(name.startswith(DELAY) for name in fitted.candidate.base)):
        return fitted
    for parts in PARTS:
        finer = replace(windows, layout=replace(windows.layout, fine=parts))
        finer.place = windows.place
        left = windows.features(fitted.candidate)
        change, usual = (_rms(one, windows.layout) for one in (finer.features(fitted.candidate) - left, left))
        if not np.any(change > MATTERS * np.maximum(1.0, MATTERS * usual)):
            break
        windows.layout = finer.layout
        fitted = settled(windows, fitted.candidate, fitted.free, turns=TURNS_OF_BASE)
    return fitted


def _rms(features: Array, layout: Layout) -> Array:
    """Return the rms of features (windows, d) of each sensor (sensors,)."""
    return np.asarray(np.sqrt(np.mean(features.reshape(len(features), len(layout.measured.sensors), -1) ** 2, axis=(0, 2))))


def best_begun(windows: Windows, begun: Candidate, fitted: Fitted, names: Iterable[str]) -> Fitted:
    """Return the best of a fit and those that begin with one of the named base parameters well below or above where that began.

    One fit may be far from the best, as with a resonance that is declared elsewhere; one that the tests do not tell from the first
    (likelihood ratio at the level of all claims) is no better. ``windows`` are left begun where the best has them.
    """
    from scipy.special import chdtri

    best, place, least = fitted, windows.place, fitted.loss - 0.5 * float(chdtri(1, LEVEL))
    for one in fitted.free:
        for factor in (1.0 / BEGUN_APART, BEGUN_APART) if not one.effect and one.name in names else ():
            start = one.put(begun, factor * one.value_in(begun))
            own = windows.begun_for(start, place)
            found = settled(own, start, fitted.free, turns=TURNS_OF_BASE)
            if found.loss < min(best.loss, least):
                best, windows.place = found, own.place
    return best


def begun_anew(windows: Windows, fitted: Fitted) -> Fitted:
    """Return the better of a fit and one whose unseen states begin where the fitted model leads them, from each test's start on.

    Readings may tell such a state in more than one place, as a speed of which nothing but the size is measured: then it stays about
    where the declared parameters have led it. ``windows`` are left begun where the better has them.
    """
    if not windows.unseen.any() or windows.layout.memory or not np.isfinite(fitted.loss):
        return fitted
    for _ in range(TURNS_OF_BASE):
        own = replace(windows)
        own.place = windows.place
        begin_hidden(own, fitted.candidate)
        own.move_starts(fitted.candidate)
        found = settled(own, fitted.candidate, fitted.free, turns=TURNS_OF_BASE)
        if not found.loss < fitted.loss - SETTLED:
            break
        fitted, windows.place = found, own.place
    return fitted


def power_of(width: int, order: int) -> float:
    """Return how often as large a power of time is at the end of a window as at the end of its first half."""
    return ((width - 1) / (width // 2 - 1)) ** order


def _begun(measured: Measured, kernels: Kernels, candidate: Candidate, width: int, effort: str) -> Windows:
    """Return the windows, each begun as measured, a state that nothing measures where the window before left it."""
    full = Layout(measured, width)
    if not len(full.of_test):
        raise UsageError(f"the tests are shorter than one window of {width} samples")
    layout = Layout(measured, width, min(MOST_SAMPLES[effort] / (len(full.of_test) * width), 1.0))
    states, _ = estimated(measured)
    joined = layout.joined(states)
    declared = list(measured.plant.states.values())
    sizes = np.array([_usual(joined[:, k], item.typical) for k, item in enumerate(declared)])
    lowest = np.array([item.low for item in declared])
    unseen = np.all(~np.isfinite(joined), axis=0)
    before = Windows(full, kernels, first_starts(full, full.joined(states)), sizes, lowest, unseen)
    begin_hidden(before, candidate)
    return Windows(layout, kernels, before.starts[layout.looked_at], sizes, lowest, unseen)


def _free(item: object, value: float | None) -> Free:
    from hjcamp.model.declare.parameter import Parameter

    assert isinstance(item, Parameter)
    low, high = item.bounds
    now = item.default if value is None else value
    log = item.prior != "uniform" and low > 0.0
    scale = abs(now) or abs(item.default) or 1.0
    return Free("", item.name, scale, low, high, log)


def _usual(values: Array, typical: float) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) or abs(typical) if len(known) else abs(typical)


def first_starts(layout: Layout, joined: Array) -> Array:
    """Return the starts (windows, states): what is measured, else a state's usual size where it has a lowest value, else 0."""
    starts = joined[:: layout.width].copy()
    for k, item in enumerate(layout.measured.plant.states.values()):
        guess = item.typical if np.isfinite(item.low) else 0.0
        starts[:, k] = np.where(np.isfinite(starts[:, k]), starts[:, k], guess)
    return starts


def begin_hidden(windows: Windows, candidate: Candidate) -> None:
    """Let a state that nothing measures begin each window where the window before left it, from the first of its test on.

    To first order in the starts (condensing), twice: copied from window to window, each turn, it would be known two windows long.
    """
    unseen = windows.unseen
    if not unseen.any():
        return
    following = np.flatnonzero(windows.layout.goes_on)
    for _ in range(2):
        ends, passed = windows.passed(candidate)
        starts, moved = windows.starts / windows.sizes, np.zeros_like(ends)
        for w in following:
            jump = (ends[w - 1] + passed[w - 1] @ moved[w - 1] - starts[w])[unseen]
            most = FARTHEST_MOVED * np.maximum(1.0, np.abs(starts[w][unseen]))
            moved[w, unseen] = np.clip(np.where(np.isfinite(jump), jump, 0.0), -most, most)
        windows.starts = np.maximum(windows.starts + moved * windows.sizes, windows.lowest)


def _filled(windows: Windows, candidate: Candidate) -> Array:
    """Return the states (n, states) with what nothing measures as the model has it."""
    joined = windows.layout.joined(estimated(windows.layout.measured)[0])
    if np.all(np.isfinite(joined)):
        return joined
    passed = windows.readings(candidate)[1]
    return np.where(np.isfinite(joined), joined, passed)
