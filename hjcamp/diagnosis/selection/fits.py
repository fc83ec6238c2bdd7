"""Models of a search as they are fitted: from where each begins, and what it leaves of blocks that it does not know."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.candidates.equivalence import is_lag, kind_of, replaces
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
from hjcamp.diagnosis.candidates.visited_range import Range, largest_commands, visited_shapes
from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free, fit, settled
from hjcamp.diagnosis.estimation.likelihood import loss, size
from hjcamp.diagnosis.levels import FITTED_STARTS, TRIED_ROUNDS, TRIED_STARTS
from hjcamp.diagnosis.residuals.windows import Place, Windows
from hjcamp.diagnosis.screening.screening import (
    Probe,
    ProbedModel,
    Projection,
    Promise,
    free_of_effect,
    free_of_unknown,
    probes_of,
    probes_of_unknown,
    refined,
)
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.blocks import left_out
from hjcamp.model.compile.source_text import names_in
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.language.vocabulary import read_vocabulary

Report = Callable[[str, float], None]
Given = TypeVar("Given")
Found = TypeVar("Found")


@dataclass
class Fits:
    """What fitting needs: the windows, the effects that may be missing, the unknowns, the blocks, the base's parameters.

    ``declared`` are the base's parameters before they were fitted, and ``first`` where windows began then; ``begins`` say where
    effects begin as well.
    """

    windows: Windows
    library: Mapping[str, type[Effect]]
    unknowns: Mapping[str, Unknown]
    blocks: NDArray[np.int64]
    base_free: Sequence[Free]
    ranges: Mapping[str, Range]
    seed: int = 1
    report: Report = lambda text, share: None
    workers: int = 1
    begins: dict[str, dict[str, float]] = field(default_factory=dict)
    declared: Mapping[str, float] = field(default_factory=dict)
    first: Place | None = None
    #: Where the tests have been: values of signals, states and the time along them, SI.
    seen_along: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    _probed: tuple[Fitted, ProbedModel] | None = None

    def visits_of(self, known: Unknown) -> NDArray[np.float64]:
        """Return where the tests have been of what drives an unknown, SI, within a turn where it repeats; empty where not known."""
        names = known.signal.split(" - ")
        found = [self.seen_along.get(name, np.zeros(0)) for name in names]
        if len({len(one) for one in found}) > 1:
            return np.zeros(0)
        course = found[0] - sum(found[1:])
        course = course[np.isfinite(course)]
        return known.low + (course - known.low) % (known.high - known.low) if known.turns else course

    def scored(self, fitted: Fitted, windows: Windows | None = None) -> Scored:
        """Return a fit with what it leaves of blocks that it does not know, over windows that begin where it has them."""
        names, windows = tuple(fitted.candidate.effects), windows or self.windows
        if not np.isfinite(fitted.loss):
            return Scored(names, fitted, fitted.features, math.inf, windows.place)
        features = left_out(windows, fitted, self.blocks)
        return Scored(names, fitted, features, size(features), windows.place)

    def each(self, work: Callable[[Given], Found], given: Sequence[Given], words: Callable[[Given], str]) -> list[Found]:
        """Return what ``work`` makes of each of ``given``, in order, by ``workers`` threads: a kernel leaves the interpreter free."""
        found: list[Found] = []
        with ThreadPoolExecutor(self.workers) as pool:
            try:
                for one, made in zip(given, pool.map(work, given), strict=True):
                    found.append(made)
                    self.report(words(one), len(found) / len(given))
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return found

    def replaced(self, candidate: Candidate) -> set[str]:
        """Return the forms of contacts of which another effect leaves nothing."""
        own = [name for name in self.library if name in candidate.effects]
        pairs = [(one, other) for k, one in enumerate(own) if one in self.windows.forms for other in own[k + 1 :]]
        return {one for one, other in pairs if replaces(self.library[other], self.library[one])}

    def acting(self, candidate: Candidate) -> tuple[Hashable, ...]:
        """Return what tells a candidate from those that act otherwise."""
        return candidate.without(self.replaced(candidate)).key

    def free_of(self, candidate: Candidate) -> list[Free]:
        """Return all free parameters of a candidate: of the form of a contact that could be an effect how far it gives way, no more.

        What another effect leaves nothing of has none.
        """
        late, replaced = self.late_inputs(candidate), self.replaced(candidate)
        found = [one for one in self.base_free if one.name not in late]
        for name in (one for one in candidate.effects if one not in replaced):
            if name in self.unknowns:
                found += free_of_unknown(self.unknowns[name])
                continue
            effect = self.library[name]
            whole = name not in self.windows.forms or not effect.claimed
            most = largest_commands(effect, self.windows.layout.measured.plant, self.ranges)
            free = [replace(one, high=min(one.high, most.get(one.name, one.high))) for one in free_of_effect(effect)]
            found += [one for one in free if whole or one.name == effect.granted]
        return found

    def fitted(self, start: Candidate, near: Fitted | None = None) -> Scored:
        """Return the fit of a model from ``start``; ``near`` lends it slopes to begin with.

        Each model has starts of its own: those of another one favour that.
        """
        own = self.begun_at(start, near)
        return self.scored(self.settled(start, near, own), own)

    def settled(self, start: Candidate, near: Fitted | None = None, windows: Windows | None = None) -> Fitted:
        """Return the fit of a model from ``start`` with the starts of ``windows``, or its own, moved along."""
        start = self.on_time(start)
        return settled(windows or self.begun_at(start, near), start, self.free_of(start), near)

    def begun_at(self, start: Candidate, near: Fitted | None) -> Windows:
        """Return windows of its own for a fit: where it was left that goes on, as they were first where the base is as declared.

        All others begin where the windows are: what nothing measures is there where the base, or the last model, has led it.
        """
        start = self.on_time(start)
        if near is not None and near.place is not None and near.candidate.key == start.key:
            own = copy.copy(self.windows)
            own.place = near.place
            return own
        if self.first is not None and self.declared.items() <= start.base.items():
            return self.windows.begun_for(start, self.first)
        return copy.copy(self.windows)

    def probed_model(self, fitted: Fitted) -> ProbedModel:
        """Return the model in addition to which effects are probed, made once for each fit."""
        if self._probed is None or self._probed[0] is not fitted:
            self._probed = (fitted, ProbedModel.of(self.windows, fitted))
        return self._probed[1]

    def probes(self, fitted: Fitted, name: str) -> list[Probe]:
        """Return the probes of a named effect or an unknown in addition to a fitted model."""
        probed_model = self.probed_model(fitted)
        if name in self.unknowns:
            return list(probes_of_unknown(self.windows, probed_model, self.unknowns[name]))
        return list(probes_of(self.windows, probed_model, self.library[name], self.visited(name)))

    def visited(self, name: str) -> dict[str, Range]:
        """Return what the tests visit of the shapes of an effect."""
        return visited_shapes(self.library[name], self.windows.layout.measured.plant, self.ranges)

    def begun(self, projection: Projection, name: str, promises: Sequence[Promise]) -> Fitted:
        """Return the best fit after few rounds: from where a named effect promises most, and from its usual values.

        What is promised is linear: the best start of a curved law need not be the one that promises most. Where the base has a delay in
        its place every start is fitted to the end, also without that: few rounds do not lead there.
        """
        before, effect = projection.fitted, self.library[name]
        most = sorted((one for one in promises if one.gain > 0.0), key=lambda one: -one.gain)[:TRIED_STARTS]
        own = [dict(effect.defaults()), *([self.begins[name]] if name in self.begins else [])]
        if most:
            most.append(refined(self.windows, self.probed_model(before), projection, effect, most[0], self.visited(name)))
            own.append(dict(most[0].candidate.effects[name]))
        starts = [one.candidate for one in most] + [before.candidate.with_effect(name, one) for one in own]
        if self.windows.layout.short:
            # the base may have taken the place of the effect
            starts += [before.candidate.with_base(self.declared).with_effect(name, one) for one in own]
        late = self.late_base(name, before.candidate)
        if late:
            starts += [self.plain(one, before.candidate) for one in starts]
        return self.best_of(starts, before, late)

    def late_base(self, name: str, candidate: Candidate) -> bool:
        """Whether the base has the delay of an input in the place of a lag."""
        effect = self.library[name]
        late = any(value > 0.0 for key, value in candidate.base.items() if key.startswith(DELAY))
        return late and is_lag(effect)

    def late_inputs(self, candidate: Candidate) -> set[str]:
        """Return the delays of inputs that the base has no more, since an effect of the drive makes them late, or effects all sensors.

        Both would say the same, one early where the other is later.
        """
        measured = self.windows.layout.measured
        vocabulary = read_vocabulary(measured.plant)
        late = [self.library[name] for name in candidate.effects if name in self.library and self.library[name].states]
        shown = {measured.plant.measured[one.field].sensor for one in measured.sensors}
        if shown <= {slot for one in late if kind_of(one) == "sensor" for slot in one.terms}:
            return {one.name for one in self.base_free if one.name.startswith(DELAY)}
        demands = {port.names["command"]: port.names["demand"] for port in vocabulary.ports.values() if port.kind == "actuator"}
        lines = {one.target: one.expression for one in vocabulary.statements}
        found = set()
        for slot in {slot for one in late if kind_of(one) == "actuator" for slot in demands.keys() & one.terms.keys()}:
            found |= {DELAY + one.removeprefix("u_") for one in names_in(lines.get(demands[slot], "")) if one.startswith("u_")}
        return found

    def on_time(self, candidate: Candidate) -> Candidate:
        """Return a candidate without the delays of inputs that its effects make late."""
        late = self.late_inputs(candidate) & set(candidate.base)
        return candidate.with_base(dict.fromkeys(late, 0.0)) if late else candidate

    def begun_unknown(self, before: Fitted, promise: Promise) -> Fitted:
        """Return the better of two starts of an unknown: what is promised, and nothing."""
        name, knots = promise.effect, self.unknowns[promise.effect].amplitudes
        zero = {**promise.candidate.effects[name], **dict.fromkeys(knots, 0.0)}
        return self.best_of([promise.candidate, before.candidate.with_effect(name, zero)], before)

    def best_of(self, starts: Sequence[Candidate], before: Fitted, to_the_end: bool = False) -> Fitted:
        """Return the best fit after few rounds from those starts that are best as they are, and from the plain one of the best.

        Of short tests all are fitted to the end, and where it is asked those that fit some of the windows best: what is best as it is
        often leads nowhere.
        """
        starts = [self.on_time(one) for one in starts]
        distinct = {self.acting(one): one for one in starts}
        if self.windows.layout.short or to_the_end:
            distinct = self._ahead(distinct)
            best = min((self.settled(one) for one in distinct.values()), key=lambda one: one.loss)
            plain = self.plain(best.candidate, before.candidate)
            if self.acting(plain) == self.acting(best.candidate):
                return best
            return min(best, self.settled(plain), key=lambda one: one.loss)
        left = {key: loss(self.windows.features(one)) for key, one in distinct.items()}
        starts = sorted(starts, key=lambda one: left[self.acting(one)])[:FITTED_STARTS]
        starts.append(self.plain(starts[0], before.candidate))
        distinct = {self.acting(one): one for one in starts}
        tried = [fit(self.windows, one, self.free_of(one), TRIED_ROUNDS, before, exact=False) for one in distinct.values()]
        return min(tried, key=lambda one: one.loss)

    def _ahead(self, starts: dict[tuple[Hashable, ...], Candidate]) -> dict[tuple[Hashable, ...], Candidate]:
        """Return where those starts lead, by how they act, that fit some of the windows best; all where windows are few."""
        some, ended = self.windows.some(), []
        if some.layout is self.windows.layout:
            return starts
        for one in starts.values():
            own = copy.copy(some)
            own.move_starts(one)
            ended.append(settled(own, one, self.free_of(one)))
        best = sorted(ended, key=lambda one: one.loss)[:FITTED_STARTS]
        return {self.acting(one.candidate): one.candidate for one in best}

    def plain(self, candidate: Candidate, before: Candidate) -> Candidate:
        """Return a candidate without the forms of contacts that were there before, and without delays of inputs.

        A base takes them in place of what is missing, and a fit that begins with them may never get rid of them.
        """
        delays = [one.name for one in self.base_free if one.name.startswith(DELAY)]
        return candidate.without(self.windows.forms & set(before.effects)).with_base(dict.fromkeys(delays, 0.0))

    def resettled(self, model: Scored) -> Scored:
        """Return a model with the windows' starts moved to where it fits best, if that is better, and leave them there."""
        self.windows.place = model.place
        found = self.scored(self.settled(model.fitted.candidate, model.fitted, self.windows))
        best = min(found, model, key=lambda one: one.left_out)
        self.windows.place = best.place
        return best
