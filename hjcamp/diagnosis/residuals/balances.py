r"""Balances: what a state's change and its rate, both at measured states, differ by; nothing is simulated.

Of a state x whose rate f depends on measured states alone, with test functions :math:`\varphi_j` that vanish at the ends of each window
(weak form; Shinbrot 1957; Messenger & Bortz 2021, doi:10.1137/20M1343166):

.. math:: b_{wj} = \int_w \varphi_j\,(\dot x - f(x, u))\,\mathrm{d}t, \quad
          c_w = \overline{x - \int_0^t f\,\mathrm{d}t}\;\Big|_w - \text{its mean over the block}

b is the balance over a window (forces of a body, flows of a store, heat of a thermal mass), c that over a whole block, which shows what
is small and lasts; beyond the parts that are left out by turns nothing adds up, so these stay independent. A contact is balanced while
it slides. Both are in units of what the sensors' noise makes of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.counts import between_counts, counted_in_steps
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.residuals.gains import Gains, Rated
from hjcamp.diagnosis.residuals.initial_states import best_sensors, estimated, on_sensors, rate_of, shown_by, smoothed_over
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.diagnosis.residuals.simulated import ZERO, Predicted
from hjcamp.diagnosis.residuals.weak_form import ORDERS, slides, test_functions
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.language.vocabulary import read_vocabulary
from hjcamp.model.run.rates import Along

Array = NDArray[np.float64]
# Draws of the sensors' noise by which the noise of a balance is found, and what it is where nothing is missing.
DRAWS = 12
# Stores whose noise is correlated by more than this share it: what a piston between them displaces goes from one to the other.
SHARED = 0.5
# In standard deviations of a measured state: a model whose next window begins farther off has no path across that seam.
TORN = 5.0


@dataclass(frozen=True)
class Balance:
    """The balance of one state: its place among the states, and ``whole`` where it counts over whole blocks too."""

    state: int
    name: str
    whole: bool

    @property
    def features(self) -> int:
        """How many numbers it gives for each window."""
        return ORDERS + self.whole

    @property
    def lasting(self) -> str:
        """The channel of what counts over whole blocks: it is little within a window."""
        return f"{self.name}_over_a_block"

    @property
    def channels(self) -> dict[str, int]:
        """The channels by which it is judged, with how many numbers of a window each has."""
        return {self.name: ORDERS} | ({self.lasting: 1} if self.whole else {})


class Usual(NamedTuple):
    """What the balances (windows, features) of a true model are: as states are estimated, and of its predicted states alone."""

    estimated: Array
    simulated: Array


@dataclass
class Balances:
    """The balances of the windows of a layout, at ``states`` (n, states) as they were measured, or filled in where nothing measures.

    ``blocks`` (windows,) are left out by turns; ``usual`` is what they are where the base is true, ``further`` what more draws of the
    noise make of that. ``scale`` (features,) is that noise, and ``apart`` (features, features) what makes independent what stores
    share of it.
    """

    layout: Layout
    kernels: Kernels
    states: Array
    moving: Array
    blocks: NDArray[np.int64]
    balanced: tuple[Balance, ...] = ()
    scale: Array = field(default_factory=lambda: np.ones(1))
    apart: Array = field(default_factory=lambda: np.eye(1))
    usual: Usual = field(default_factory=lambda: Usual(np.zeros(1), np.zeros(1)))
    further: Array = field(default_factory=lambda: np.zeros(1))

    @classmethod
    def of(
        cls, layout: Layout, kernels: Kernels, base: Candidate, predicted: Predicted, blocks: NDArray[np.int64]
    ) -> Self | None:
        """Return those that the measured states allow, None without any; ``predicted`` is what the ``base`` predicts."""
        states = _known(layout, layout.measured)
        seen = np.asarray(np.isfinite(states).all(axis=0))
        moving = _sides(layout, states)
        found = cls(layout, kernels, np.where(np.isfinite(states), states, predicted.states), moving, blocks)
        found.balanced = tuple(found._able(base, seen))
        if not found.balanced:
            return None
        shown = predicted._replace(readings=found._counted_paths(predicted.readings - found._zeros(base)))
        drawn = found._drawn(base, shown, DRAWS)
        noise = np.var(drawn, axis=0, ddof=1)
        found.scale = np.sqrt(np.maximum(np.sum(noise, axis=0) / np.maximum(np.sum(noise > 0.0, axis=0), 1), 1e-300))
        found.apart = found._independent((np.array(drawn) - np.mean(drawn, axis=0)) / found.scale)
        found.further = np.mean(drawn, axis=0) - np.mean(found._drawn(base, shown, 2, counted=False), axis=0)
        found.usual = found.usual_of(base, predicted)
        return found

    def features(self, candidate: Candidate, predicted: Predicted | None = None, usual: Usual | None = None) -> Array:
        """Return the balances (windows, features) less what they are where nothing is missing, in units of their noise."""
        usual = usual or self.usual
        raw = self._raw(candidate, self._measured(candidate)) - usual.estimated
        if predicted:
            raw = raw - self._of_sensors(candidate, predicted) - self._of_memory(candidate, predicted, usual)
        with np.errstate(invalid="ignore", over="ignore"):
            return np.asarray(raw / self.scale @ self.apart)

    def _independent(self, noise: Array) -> Array:
        """Return the inverse root of the correlation of draws of noise (draws, windows, features), among stores alone."""
        found, begins = np.eye(noise.shape[2]), np.cumsum([0, *(one.features for one in self.balanced)])
        stores = np.array([begin for begin, one in zip(begins[:-1], self.balanced, strict=True) if one.whole], dtype=np.int64)
        for own in (stores + k for k in range(ORDERS + 1)):
            moments = np.einsum("dwi,dwj->ij", noise[:, :, own], noise[:, :, own])
            size = np.sqrt(np.maximum(np.diag(moments), 1e-300))
            correlation = moments / np.outer(size, size)
            if np.any(np.abs(correlation - np.diag(np.diag(correlation))) > SHARED):
                values, vectors = np.linalg.eigh(correlation)
                found[np.ix_(own, own)] = (vectors / np.sqrt(np.maximum(values, 1e-3))) @ vectors.T
        return found

    def _counted_paths(self, readings: Array) -> Array:
        """Return predicted readings (n, sensors) with those measured where counts are most of the noise, as they are between counts.

        How coarse a path is depends on where it went: a model that misses a slip counts nothing there.
        """
        layout, found, measured = self.layout, readings.copy(), self.layout.measured
        for k in np.flatnonzero(measured.steps**2 / 6.0 > measured.noise**2):
            found[:, k] = layout.joined([between_counts(test.readings[:, k]) for test in measured.tests])
        return found

    def _zeros(self, candidate: Candidate) -> Array:
        """Return where counters begin to count (sensors,) in a candidate, SI."""
        return np.array([candidate.base.get(ZERO + one.field, 0.0) for one in self.layout.measured.sensors])

    def _measured(self, candidate: Candidate) -> Array:
        """Return the measured states (n, states) of a candidate: counters that show them begin where it has their zeros."""
        zeros = self._zeros(candidate)
        plant: Any = self.layout.measured.plant
        if not zeros.any():
            return self.states
        states = self.states.copy()
        for of, k in best_sensors(self.layout.measured).items():
            states[:, list(plant.states).index(of)] -= zeros[k] / shown_by(plant, self.layout.measured.sensors[k].field)[1]
        return states

    def usual_of(self, candidate: Candidate, predicted: Predicted) -> Usual:
        """Return what the balances of a model are where it is true, by what it predicts.

        Of what the predicted states themselves balance to, that within windows is part of it (a sum in the place of an integral),
        not how far off the next one begins. Where that is far, what is estimated across the seam is no state of the model: nothing is
        known of it there.
        """
        plain = candidate.without(self._erring(candidate))
        predicted = predicted._replace(readings=predicted.readings - self._zeros(candidate))
        drawn = np.mean(self._drawn(plain, predicted, 2, counted=False), axis=0) + self.further
        states = np.where(np.isfinite(predicted.states), predicted.states, self.states)
        rates = self._rated(plain, states)
        simulated = self._of_rates(rates, states, predicted.ends)
        errs = len(plain.effects) < len(candidate.effects)
        of_chain = drawn - (self._raw(plain, self._shown(predicted, rates.along)) if errs else self._of_rates(rates, states))
        of_chain[self._torn(predicted)] = 0.0
        return Usual(simulated + of_chain, simulated)

    def _torn(self, predicted: Predicted) -> NDArray[np.bool_]:
        """Return whether a window ends or begins far from where its neighbour does (windows,), in units of what is known of states."""
        first = predicted.states[:: self.layout.width]
        seams = np.flatnonzero(self.layout.goes_on & self.layout.begun)
        jump = np.abs(first[seams] - predicted.ends[seams - 1]) / self._errors
        far = seams[np.any(jump > TORN, axis=1)]
        found = np.zeros(len(first), dtype=bool)
        found[far] = found[far - 1] = True
        return found

    def _able(self, base: Candidate, seen: NDArray[np.bool_]) -> list[Balance]:
        """Return the states that can be balanced: measured, of which the rate is an equation of measured states alone."""
        plant: Any = self.layout.measured.plant
        names, contacts = list(plant.states), {one.velocity for one in read_vocabulary(plant).contacts}
        kinematic = set(rate_of(plant).values())
        usual = np.array([item.typical for item in plant.states.values()])
        before = self._gains.along(base, self.states).before
        hidden = self.states.copy()
        hidden[:, ~seen] += 0.1 * usual[~seen]
        moved = self._gains.along(base, hidden).before if (~seen).any() else before
        # the friction of a contact, which no one knows while it is held, acts on whatever its side changes
        braked = np.any(replace(self._gains, moving=-self.moving).along(base, self.states).before != before, axis=0)
        found = []
        for k, name in enumerate(names):
            if seen[k] and name not in kinematic and np.array_equal(moved[:, k], before[:, k]):
                found.append(Balance(k, name, whole=name not in contacts and not braked[k]))
        return found

    @cached_property
    def _errors(self) -> Array:
        """The standard deviation of each measured state (states,), SI."""
        return estimated(self.layout.measured)[1]

    def _of_sensors(self, candidate: Candidate, predicted: Predicted) -> Array | float:
        """Return what the balances (windows, features) are by what a candidate's sensors err by, with a memory or without.

        It is that of the predicted states as these sensors show them, less that of these states: the noise stays what it is.
        """
        names = self._erring(candidate)
        if not names:
            return 0.0
        plain = candidate.without(names)
        right = self._rated(plain, predicted.states)
        predicted = predicted._replace(readings=predicted.readings - self._zeros(candidate))
        return self._raw(plain, self._shown(predicted, right.along)) - self._of_rates(right, predicted.states)

    def _shown(self, predicted: Predicted, right: Along) -> Array:
        """Return predicted states (n, states) as their sensors show them, errors and all; ``right`` has the readings without errors."""
        layout, shown = self.layout, predicted.states.copy()
        plant: Any = layout.measured.plant
        for of, k in best_sensors(layout.measured).items():
            field = layout.measured.sensors[k].field
            error = predicted.readings[:, k] - right.readings[:, list(plant.measured).index(field)]
            error = error / shown_by(plant, field)[1]
            shown[:, list(plant.states).index(of)] += error
            above = next((rate for rate, one in rate_of(plant).items() if one == of), "")
            if above:
                slope = np.asarray(np.gradient(error.reshape(-1, layout.width), layout.measured.period, axis=1))
                shown[:, list(plant.states).index(above)] += slope.ravel()
        return shown

    def _erring(self, candidate: Candidate) -> set[str]:
        """Return a candidate's effects by which sensors err."""
        effects = [self.kernels.effects[name] for name in candidate.effects]
        return {one.name for one in on_sensors(self.layout.measured.plant, effects)}

    def _of_memory(self, candidate: Candidate, predicted: Predicted, usual: Usual) -> Array | float:
        """Return what the balances (windows, features) are by what effects remember as a test begins, which nothing measures.

        Driven along the predicted states, which know it, they begin as declared as well.
        """
        effects = [self.kernels.effects[name] for name in candidate.effects]
        plain = candidate.without(self._erring(candidate))
        if not any(one.states and not one.granted for one in effects if one.name in plain.effects):
            return 0.0
        return self._raw(plain, predicted.states, predicted.ends) - usual.simulated

    def _raw(self, candidate: Candidate, states: Array, ends: Array | None = None) -> Array:
        """Return the balances (windows, features) at states (n, states), each in the unit of its state; ``ends`` as in `Gains.of`."""
        return self._of_rates(self._rated(candidate, states), states, ends)

    def _of_rates(self, rated: Rated, states: Array, ends: Array | None = None) -> Array:
        """Return the balances (windows, features) of states (n, states) with these rates, see `_raw`."""
        parts = []
        # of a model that diverges there are no numbers
        with np.errstate(invalid="ignore", over="ignore"):
            beyond = self._gains.beyond(states, ends) if rated.slopes else []
            for one in self.balanced:
                gained = self._gains.of(one.state, rated, states, ends, beyond if one.whole else ())
                parts.append((gained.reshape(-1, 1, self.layout.width) @ self._tests[one.name])[:, 0])
                if one.whole:
                    parts.append(self._whole(gained)[:, None])
        return np.concatenate(parts, axis=1)

    def _rated(self, candidate: Candidate, states: Array) -> Rated:
        return self._gains.rated(candidate, states, sloping=any(one.whole for one in self.balanced))

    @cached_property
    def _gains(self) -> Gains:
        return Gains(self.layout, self.kernels, self.moving)

    def _whole(self, gained: Array) -> Array:
        """Return the mean in each window of what adds up over its block (windows,), less the block's mean."""
        runs = np.cumsum(self.layout.fresh | np.append(True, np.diff(self.blocks) != 0)) - 1
        own = np.cumsum(gained).reshape(-1, self.layout.width).mean(axis=1)
        return np.asarray(own - (np.bincount(runs, own) / np.bincount(runs))[runs])

    @cached_property
    def _tests(self) -> dict[str, Array]:
        """The test functions of each balance (windows, width, orders): over the longest stretch of a window in which it slides."""
        layout, plant = self.layout, self.layout.measured.plant
        contacts = [one.velocity for one in read_vocabulary(plant).contacts]
        smoothed, found = smoothed_over(layout.measured), {}
        for one in self.balanced:
            use = np.ones((len(layout.of_test), layout.width), dtype=bool)
            if not one.whole:
                own = [contacts.index(one.name)] if one.name in contacts else range(len(contacts))
                for k in own:
                    use &= slides(self.moving[:, k], smoothed.get(contacts[k], 0)).reshape(use.shape)
            found[one.name] = np.stack([test_functions(row) for row in use])
        return found

    def _drawn(self, model: Candidate, predicted: Predicted, draws: int, counted: bool = True) -> list[Array]:
        """Return a model's balances (windows, features) of predicted readings with draws of the sensors' noise.

        They are ``counted`` as the sensors count (what that makes of a few draws does not cancel), and go through the same chain
        (indirect inference: Gourieroux, Monfort & Renault 1993, doi:10.1002/jae.3950080507).
        """
        layout, generator, drawn = self.layout, np.random.default_rng(1), []
        measured, states = layout.measured, np.where(np.isfinite(predicted.states), predicted.states, self.states)
        paths = layout.apart_again(np.where(np.isfinite(predicted.readings), predicted.readings, layout.readings))
        white = np.sqrt(np.maximum(measured.noise**2 - measured.steps**2 / 12.0, 0.0))
        for _ in range(draws // 2):
            errors = [white * generator.standard_normal(path.shape) for path in paths]
            phases = [generator.uniform(size=len(white)) for _ in paths]
            # with both signs: what is linear in the noise cancels in the mean, whatever was drawn for which test
            for sign in (1.0, -1.0):
                noisy = [path + sign * error for path, error in zip(paths, errors, strict=True)]
                if counted:
                    noisy = [
                        counted_in_steps(one, measured.steps, sign * phase) for one, phase in zip(noisy, phases, strict=True)
                    ]
                tests = [replace(test, readings=one) for test, one in zip(measured.tests, noisy, strict=True)]
                seen = _known(layout, measured.with_tests(tests))
                drawn.append(self._raw(model, np.where(np.isfinite(seen), seen, states)))
        return drawn


def _known(layout: Layout, measured: Measured) -> Array:
    """Return the measured states (n, states), NaN where nothing tells them."""
    return layout.joined(estimated(measured)[0])


def _sides(layout: Layout, states: Array) -> Array:
    """Return on which side each contact is (n, contacts): 0 where it rests or nothing tells."""
    plant: Any = layout.measured.plant
    names = list(plant.states)
    columns = [np.sign(np.nan_to_num(states[:, names.index(one.velocity)])) for one in read_vocabulary(plant).contacts]
    return np.column_stack(columns) if columns else np.zeros((len(states), 0))
