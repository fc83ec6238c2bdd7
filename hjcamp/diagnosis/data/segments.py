"""Tests cut into windows, and which of these are looked at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.between_samples import halves
from hjcamp.diagnosis.data.measured_test import MeasuredTest
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.model.declare.course import Given

Array = NDArray[np.float64]
ORDERS = 8
# Samples of a window: four of its eight features are left where a log is so short that it would have too few windows.
SHORTEST, SHORTEST_OF_ALL = 24, 16
# So many windows at least: the moments of eight features are known to a tenth from about a hundred.
WINDOWS = 96
# Where not all windows are looked at, about so many follow one another: an effect that remembers knows where it is but in the first.
RUN = 8
# A test has so many such runs at least.
RUNS_OF_TEST = 4
# So many sets of delayed inputs are kept, fewer of long logs: these many bytes of them.
MOST_DELAYED, MOST_BYTES = 16, 64 * 2**20
# The parameter of an effect that is the number of a test's condition.
NUMBER = "condition_number"


@dataclass(frozen=True)
class Layout:
    """Tests cut into windows of ``width`` samples, of which a ``share`` is looked at; the rest of a test belongs to none.

    ``apart``: no window goes on from the one before it. ``memory``: where it is not 0, a test begins once and is simulated through,
    and a start is forgotten in so many samples. ``fine``: a sample is simulated in so many parts, each under the mean of what is given.
    ``every``: of the runs of windows that are looked at, one in so many.
    """

    measured: Measured
    width: int
    share: float = 1.0
    apart: bool = False
    memory: int = 0
    fine: int = 1
    every: int = 1

    def predictions(self, features: Array) -> Array:
        """Return what of features (..., d) are predictions over windows (..., sensors x orders); balances stand behind them."""
        return np.asarray(features[..., : len(self.measured.sensors) * self.basis.shape[1]])

    @cached_property
    def whole(self) -> list[int]:
        """Number of windows that each test has."""
        return [test.samples // self.width for test in self.measured.tests]

    @cached_property
    def counts(self) -> list[int]:
        """Number of windows of each test that are looked at."""
        return [int(one.sum()) for one in self.of_each]

    @cached_property
    def looked_at(self) -> NDArray[np.bool_]:
        """Whether each window of all tests is looked at (all windows,)."""
        return np.concatenate(self.of_each)

    @cached_property
    def of_each(self) -> list[NDArray[np.bool_]]:
        """Whether each window of each test is looked at: runs of windows, evenly spread, the first at its beginning."""
        found = []
        for count in self.whole:
            seen = round(self.share * count)
            runs = max(min(seen, RUNS_OF_TEST), seen // RUN, 1)
            ends = np.round(np.linspace(0, count, runs + 1)).astype(int)
            looked = np.arange(count) - np.repeat(ends[:-1], np.diff(ends))
            length = np.where(np.arange(runs) % self.every == 0, np.maximum(np.round(self.share * np.diff(ends)), 1), 0)
            found.append(looked < np.repeat(length, np.diff(ends)))
        return found

    @cached_property
    def of_test(self) -> NDArray[np.int64]:
        """The position of the test that each window belongs to (windows,)."""
        return np.repeat(np.arange(len(self.counts)), self.counts)

    @property
    def short(self) -> bool:
        """Whether the tests are too few samples for as many windows as there should be: then much can be tried of them."""
        return len(self.of_test) * self.width < WINDOWS * SHORTEST

    @cached_property
    def begins(self) -> NDArray[np.int64]:
        """1 where a test begins, 2 where another window of it begins again, else 0 (n,)."""
        marks = np.zeros(len(self.of_test) * self.width, dtype=np.int64)
        marks[:: self.width] = 0 if self.memory else 2
        first = np.concatenate([[0], np.cumsum(self.counts)])[:-1]
        marks[first[np.array(self.counts) > 0] * self.width] = 1
        return marks

    @cached_property
    def begun(self) -> NDArray[np.bool_]:
        """Whether each window begins from a start of its own (windows,)."""
        return np.asarray(self.begins[:: self.width] > 0)

    def joined(self, columns: Sequence[Array]) -> Array:
        """Return one array of each test (samples, ...), cut to the windows that are looked at and joined (n, ...)."""
        parts = []
        for one, count, seen in zip(columns, self.whole, self.of_each, strict=True):
            cut = one[: count * self.width].reshape(count, self.width, *one.shape[1:])[seen]
            parts.append(cut.reshape(-1, *one.shape[1:]))
        return np.concatenate(parts)

    def apart_again(self, joined: Array) -> list[Array]:
        """Return the readings of each test (samples, sensors), with these (n, sensors) in the windows that are looked at."""
        found, low = [], 0
        for test, seen in zip(self.measured.tests, self.of_each, strict=True):
            rows = np.flatnonzero(np.repeat(seen, self.width))
            own = test.readings.copy()
            own[rows] = joined[low : low + len(rows)]
            found.append(own)
            low += len(rows)
        return found

    def condensed(self) -> tuple[MeasuredTest, ...]:
        """Return the tests with nothing but the windows that are looked at, one after the other."""
        if self.share >= 1.0:
            return self.measured.tests
        ends, inputs = np.cumsum([0, *self.counts]) * self.width, self._moved({})
        return tuple(
            replace(test, time=self.time[a:b], inputs=inputs[a:b], readings=self.readings[a:b])
            for test, a, b in zip(self.measured.tests, ends[:-1], ends[1:], strict=True)
        )

    @cached_property
    def readings(self) -> Array:
        """What was measured (n, sensors), SI."""
        return self.joined([test.readings for test in self.measured.tests])

    @cached_property
    def means(self) -> Array:
        """The mean of what was measured from each start to the next (n, sensors), SI."""
        of_start = np.repeat(np.cumsum(self.begun) - 1, self.width)
        counts = np.bincount(of_start)[:, None]
        sums = [np.bincount(of_start, column) for column in self.readings.T]
        return np.asarray((np.column_stack(sums) / counts)[of_start])

    @cached_property
    def at_ends(self) -> NDArray[np.bool_]:
        """Whether a sensor reads its end (n, sensors)."""
        low, high = self.measured.ends.T
        return np.asarray((self.readings <= low) | (self.readings >= high))

    @cached_property
    def any_end(self) -> bool:
        """Whether any sensor ever reads its end."""
        return bool(self.at_ends.any())

    def held(self, predicted: Array) -> Array:
        """Return predicted readings (n, sensors), SI, held at the end of a sensor where it reads that."""
        return np.where(self.at_ends, self.measured.shown(predicted), predicted) if self.any_end else predicted

    @cached_property
    def time(self) -> Array:
        """Time since the beginning of its test (n,), s."""
        return self.joined([test.time for test in self.measured.tests])

    @cached_property
    def goes_on(self) -> NDArray[np.bool_]:
        """Whether each window begins where the one before it ends (windows,)."""
        begins, ends = self.time[:: self.width], self.time[self.width - 1 :: self.width]
        found = np.zeros(len(self.of_test), dtype=bool)
        if self.apart or self.memory:
            return found
        gap = np.abs(begins[1:] - ends[:-1] - self.measured.period)
        found[1:] = (self.of_test[1:] == self.of_test[:-1]) & (gap < 0.5 * self.measured.period)
        return found

    @cached_property
    def fresh(self) -> NDArray[np.bool_]:
        """Whether nothing tells what an effect remembers where a window begins (windows,)."""
        found = self.begins[:: self.width] == 1
        return found if self.apart or self.memory else np.asarray(found | ~self.goes_on)

    @cached_property
    def names(self) -> list[str]:
        """The names of the given inputs."""
        return [name for name in self.measured.plant.inputs if name not in ("time", "direction")]

    @cached_property
    def inputs(self) -> Array:
        """The given inputs (n, inputs of the plant), which hold from each sample to the next: of what runs linearly the mean."""
        return self._moved(self._between)

    @cached_property
    def _between(self) -> dict[int, float]:
        """By how much the mean over a sample is later (s) than what runs linearly is at its beginning, by the input's place."""
        given = self.measured.plant.inputs
        return {k: -0.5 * self.measured.period for k, name in enumerate(self.names) if given[name].hold == "linear"}

    @cached_property
    def ahead(self) -> dict[int, Array]:
        """By how much what runs linearly is more at each sample than its mean over the first part of it (n,), by the input's place."""
        logged, first = (self._moved({}), self.delayed({})[:: self.fine]) if self._between else (self.inputs, self.inputs)
        return {place: logged[:, place] - first[:, place] for place in self._between}

    def delayed(self, delays: Mapping[str, float]) -> Array:
        """Return the inputs (n fine, inputs), each later by its delay (s), and its rate with it: of each part of a sample the mean."""
        rates = self.measured.plant.rates_of_inputs().items()
        delays = {**delays, **{name: delays[source] for name, source in rates if source in delays}}
        late = {self.names.index(name): delay for name, delay in delays.items() if delay != 0.0}
        key = tuple(sorted(late.items()))
        if (found := self._delayed.get(key)) is not None:
            return found
        if self.fine > 1:
            found = self._finely(late)
        else:
            moved = {place: self._between.get(place, 0.0) + late.get(place, 0.0) for place in {*self._between, *late}}
            found = self._moved(moved) if late else self.inputs
        if len(self._delayed) >= min(MOST_DELAYED, max(MOST_BYTES // max(found.nbytes, 1), 2)):
            self._delayed.clear()
        self._delayed[key] = found
        return found

    @cached_property
    def _delayed(self) -> dict[tuple[tuple[int, float], ...], Array]:
        """Inputs by their delays, as last asked for: slopes move one parameter after the other, and that is seldom a delay."""
        return {}

    def _finely(self, late: Mapping[int, float]) -> Array:
        """Return each input in parts of each sample (n fine, inputs), those at some places later by a time (s).

        Two parts have the mean and the first moment of what is given over both, within what that is there.
        """
        pairs, (logged, (at, first, last)) = self.fine // 2, self._logged
        found = np.repeat(logged[at][:, None], self.fine, axis=1)
        within = np.repeat(first, pairs), np.repeat(last, pairs)
        for place in {*late, *self._between}:
            begins = (at[:, None] + np.arange(pairs) / pairs).ravel() - late.get(place, 0.0) / self.measured.period
            column = logged[:, place]
            runs = self._following[:, place] if place in self._between else column
            mean, apart = halves(column, runs, begins, 1.0 / pairs, within)
            found[:, :, place] = np.stack([mean - apart, mean + apart], axis=1).reshape(-1, self.fine)
        return found.reshape(-1, len(self.names))

    @cached_property
    def _logged(self) -> tuple[Array, tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]]:
        """All that was given (all samples, inputs), before the logs as well, and where each sample that is looked at stands in it,
        with the first and the last place of its test (n,).
        """
        parts, places, low = [], [], 0
        for test in self.measured.tests:
            lead, high = len(test.earlier), low + len(test.earlier) + test.samples
            parts += [test.earlier, test.inputs] if lead else [test.inputs]
            ends = np.tile([low, high - 1], (test.samples, 1))
            places.append(np.column_stack([np.arange(low + lead, high), ends]))
            low = high
        at, first, last = np.ascontiguousarray(self.joined(places).T)
        return np.concatenate(parts), (at, first, last)

    @cached_property
    def _following(self) -> Array:
        """What was given one sample later (all samples, inputs); the last of a test is its own."""
        samples = np.array([len(test.earlier) + test.samples for test in self.measured.tests])
        following = np.arange(1, samples.sum() + 1)
        following[np.cumsum(samples) - 1] -= 1
        return self._logged[0][following]

    def course(self, begins: NDArray[np.int64], inputs: Array, rows: slice | NDArray[Any], starts: Array) -> tuple[Given, int]:
        """Return some ``rows`` of the samples as a model is run through them, and in how many parts each is.

        ``begins`` (n,) marks where it begins from ``starts``, under ``inputs`` (n parts, inputs).
        """
        period, marks, time = self.measured.period, begins[rows], self.time[rows]
        parts = len(inputs) // len(self.time)
        if parts == 1:
            # a kernel is compiled anew for other orders
            return Given(period, marks, time, np.ascontiguousarray(inputs[rows]), starts), 1
        first = np.zeros((len(marks), parts), dtype=np.int64)
        first[:, 0] = marks
        times = time[:, None] + np.arange(parts) * (period / parts)
        given = inputs.reshape(-1, parts, inputs.shape[1])[rows].reshape(-1, inputs.shape[1])
        return Given(period / parts, first.ravel(), times.ravel(), np.ascontiguousarray(given), starts), parts

    def _moved(self, late: Mapping[int, float]) -> Array:
        """Return the inputs as measured (n, inputs), those at some places later by a time (s), earlier where that is negative."""
        logged, (at, first, last) = self._logged
        found = logged[at]
        for place, delay in late.items():
            whole, part = divmod(delay / self.measured.period, 1.0)
            now, before = (logged[np.clip(at - int(one), first, last), place] for one in (whole, whole + 1.0))
            found[:, place] = (1.0 - part) * now + part * before
        return found

    @property
    def groups(self) -> list[tuple[dict[str, float], NDArray[np.bool_]]]:
        """The parameters that the tests are given, and the windows (windows,) of the tests with each set of them."""
        return self.groups_by(())

    def groups_by(self, numbers: Sequence[str]) -> list[tuple[dict[str, float], NDArray[np.bool_]]]:
        """Return them with further parameters that are the number of a test's condition, by full name."""
        if (known := self._grouped.get(tuple(numbers))) is not None:
            return known
        found: dict[tuple[tuple[str, float], ...], list[int]] = {}
        conditions = list(self.measured.conditions)
        for place, test in enumerate(self.measured.tests):
            number = float(conditions.index(test.condition))
            found.setdefault((*test.given, *((name, number) for name in numbers)), []).append(place)
        own = [(dict(given), np.isin(self.of_test, places)) for given, places in found.items()]
        self._grouped[tuple(numbers)] = own
        return own

    @cached_property
    def _grouped(self) -> dict[tuple[str, ...], list[tuple[dict[str, float], NDArray[np.bool_]]]]:
        """What `groups_by` has returned: every simulation asks for it."""
        return {}

    @cached_property
    def basis(self) -> Array:
        """Legendre polynomials over a window, orthonormal (width, orders)."""
        orders = min(ORDERS, self.width // 4)
        return np.asarray(np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, self.width), orders, increasing=True))[0])

    def coefficients(self, residuals: Array) -> Array:
        """Return the coefficients (windows, sensors, orders) of residuals (n, sensors), in units of the sensor's noise.

        What a sensor reads at its end is left out: held there, residuals break off, and no start is found from their slopes.
        """
        known = np.where(self.at_ends, 0.0, residuals) if self.any_end else residuals
        with np.errstate(over="ignore", invalid="ignore"):  # a model that diverges is no warning: it is not taken
            shaped = known.reshape(-1, self.width, residuals.shape[1]) / self.measured.noise
            return np.asarray(shaped.transpose(0, 2, 1) @ self.basis)
