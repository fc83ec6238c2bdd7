"""Tests of the menu as one rival would have them: simulated whole under their inputs, or window by window along a motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.hidden_states import begin_hidden
from hjcamp.diagnosis.calibration.prediction_windows import first_starts
from hjcamp.diagnosis.data.measured_test import MeasuredTest
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.design.wanted import Wanted
from hjcamp.diagnosis.residuals.initial_states import estimated
from hjcamp.diagnosis.residuals.windows import Place, Windows
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.run.inputs_along import with_rates

Array = NDArray[np.float64]
ORDERS = 6
ROUNDS = 5
# The input's share of its usual size is worth so much of the motion's spread: what a motion hardly needs stays as it is.
RIDGE = 1e-4
# An input is not taken farther than its measured range and half of that on either side.
ROOM = 0.5
# A displaced start is kept where this share of the displacement is there in the last quarter of a test.
KEPT = 0.5


def held_by_loop(analysis: Analysis) -> bool:
    """Whether tests are motions: a loop outside the equations holds them.

    So it is where the plant says it, and where a displaced start stays displaced: nothing in the equations brings such a plant
    back; one that swings about where it was is brought back, however little it is damped. That it misses the readings under its
    logged inputs is no sign of it: something may be missing.
    """
    if analysis.measured.plant.loop == "foreign":
        return True
    windows, layout = analysis.windows, analysis.windows.layout
    if layout.memory:
        return False
    firsts = windows.starts[np.flatnonzero(layout.begins[:: layout.width] == 1)]
    model = analysis.base.fitted.candidate
    shown, _ = run(windows, model, layout.inputs, layout.begins == 1, firsts)
    lengths = [count * layout.width for count in layout.counts]
    for k, size in enumerate(windows.sizes):
        moved = firsts.copy()
        moved[:, k] += size
        apart = run(windows, model, layout.inputs, layout.begins == 1, moved)[0] - shown
        kept = [np.abs(one[3 * len(one) // 4 :].mean(axis=0)) for one in np.split(apart, np.cumsum(lengths)[:-1])]
        if np.any(np.average(kept, axis=0, weights=lengths) > KEPT * np.maximum(np.abs(apart).max(axis=0), 1e-300)):
            return True
    return False


def run(windows: Windows, candidate: Candidate, inputs: Array, begins: NDArray[np.bool_], starts: Array) -> tuple[Array, Array]:
    """Return readings (n, sensors) and plant states (n, states) under ``inputs`` (n parts, inputs), begun again where ``begins`` (n,).

    ``starts`` has a row for each of these places. Effects keep their own states within a test.
    """
    layout, measured = windows.layout, windows.layout.measured
    model, values = windows.kernels.model(candidate)
    marks = np.where(begins, np.where(layout.begins == 1, 1, 2), 0)
    out, states = np.empty((len(layout.time), len(measured.sensors))), np.empty((len(layout.time), starts.shape[1]))
    for given, members in layout.groups:
        rows = np.repeat(members, layout.width)
        p = model.vector({**values, **given})
        course, fine = layout.course(marks, inputs, rows, starts[rows[begins]])
        shown, passed = model.run_free(p, course)
        out[rows], states[rows] = shown[::fine, measured.columns], passed[::fine, : starts.shape[1]]
    return measured.shown(out), states


@dataclass(frozen=True)
class Bench:
    """The tests of a menu, ready to be simulated: their windows, and where each begins.

    ``whole`` tests run on from their start under their inputs; else each window begins at the state of a wanted motion.
    """

    windows: Windows
    whole: bool

    def simulated(self, analysis: Analysis, truth: Candidate) -> Windows:
        """Return the windows with the readings that a model gives, begun where it has them."""
        layout = self.windows.layout
        ends = layout.begins == 1 if self.whole else layout.begins > 0
        starts = self.windows.starts[layout.begins[:: layout.width] == 1] if self.whole else self.windows.starts
        inputs = layout.delayed({k.removeprefix(DELAY): v for k, v in truth.base.items() if k.startswith(DELAY)})
        shown, passed = run(self.windows, truth, inputs, ends, starts)
        begun = np.maximum(passed[:: layout.width], self.windows.lowest)
        return _windows(analysis, _read(layout, shown), np.where(np.isfinite(begun), begun, self.windows.starts))


def bench_of(analysis: Analysis, wanted: Sequence[Wanted], model: Candidate, by_motion: bool) -> Bench:
    """Return the bench of a menu; ``model`` says which inputs a wanted motion needs, and where states are that nothing measures."""
    measured = analysis.measured
    tests = tuple(_test(measured, one) for one in wanted)
    own = analysis.windows.layout
    layout = Layout(measured.with_tests(tests), own.width, memory=own.memory, fine=own.fine)
    if not by_motion:
        states = analysis.windows.readings(model)[1]
        starts = np.stack([_state_at(analysis, states, one) for one in wanted])
        windows = _windows(analysis, layout, np.repeat(starts, layout.counts, axis=0))
        return Bench(windows, whole=True)
    joined = layout.joined(estimated(layout.measured)[0])
    windows = _windows(analysis, layout, np.maximum(first_starts(layout, joined), analysis.windows.lowest))
    begin_hidden(windows, model)
    inputs = needed(analysis, windows, model)
    cuts = np.cumsum([count * layout.width for count in layout.counts])[:-1]
    tests = tuple(replace(test, inputs=own) for test, own in zip(tests, np.split(inputs, cuts), strict=True))
    apart = Layout(measured.with_tests(tests), layout.width, apart=True, fine=layout.fine)
    return Bench(_windows(analysis, apart, windows.starts), whole=False)


def needed(analysis: Analysis, windows: Windows, model: Candidate) -> Array:
    """Return the inputs (n, inputs) with which a model moves as wanted: low orders over each window, by least squares."""
    layout, measured = windows.layout, analysis.measured
    names = [name for name in measured.plant.inputs if name not in ("time", "direction")]
    known = np.concatenate([test.inputs for test in measured.tests])
    low, high = known.min(axis=0), known.max(axis=0)
    held = [name for name, item in measured.plant.given_inputs().items() if item.hold == "previous"]
    free = [k for k, name in enumerate(names) if high[k] > low[k] and name in held]
    inputs, room = layout.inputs.copy(), ROOM * (high - low)
    shapes = np.tile(layout.basis[:, :ORDERS] * np.sqrt(layout.width), (len(layout.of_test), 1))
    spread = np.std(np.concatenate([test.readings for test in measured.tests]), axis=0)
    ends = layout.begins > 0

    def left_of(tried: Array) -> Array:
        shown, _ = run(windows, model, tried, ends, windows.starts)
        values = np.nan_to_num((layout.readings - shown) / spread, nan=1e3, posinf=1e3, neginf=-1e3)
        return np.asarray(np.clip(values, -1e3, 1e3).reshape(len(layout.of_test), -1))

    left = left_of(inputs)
    for _ in range(ROUNDS if free else 0):
        columns, sizes = [], []
        for k in free:
            for order in range(shapes.shape[1]):
                moved = inputs.copy()
                size = 0.02 * (high[k] - low[k])
                moved[:, k] += size * shapes[:, order]
                columns.append((left_of(moved) - left) / 0.02)
                sizes.append((k, order, high[k] - low[k]))
        slopes = np.stack(columns, axis=2)
        square = np.einsum("wnp,wnq->wpq", slopes, slopes) + RIDGE * slopes.shape[1] * np.eye(slopes.shape[2])
        step = np.linalg.solve(square, -np.einsum("wnp,wn->wp", slopes, left)[:, :, None])[:, :, 0]
        tried = inputs.copy()
        for (k, order, size), share in zip(sizes, step.T, strict=True):
            tried[:, k] += np.repeat(share, layout.width) * size * shapes[:, order]
        tried = np.clip(tried, low - room, high + room)
        after = left_of(tried)
        better = np.sum(after**2, axis=1) < np.sum(left**2, axis=1)
        inputs = np.where(np.repeat(better, layout.width)[:, None], tried, inputs)
        left = np.where(better[:, None], after, left)
        if not better.any():
            break
    return inputs


def _test(measured: Measured, wanted: Wanted) -> MeasuredTest:
    time: Array = np.arange(wanted.samples, dtype=np.float64) * measured.period
    log = measured.tests[wanted.of].log
    inputs = with_rates(measured.plant, wanted.inputs, measured.period)
    return MeasuredTest(wanted.name, wanted.name, time, inputs, wanted.readings, wanted.given, log)


def _windows(analysis: Analysis, layout: Layout, starts: Array) -> Windows:
    of = analysis.windows
    return Windows(layout, of.kernels, starts, of.sizes, of.lowest, of.unseen)


def _read(layout: Layout, shown: Array) -> Layout:
    """Return a layout whose tests have other readings (n, sensors)."""
    cuts = np.cumsum([count * layout.width for count in layout.counts])[:-1]
    tests = tuple(
        replace(test, time=test.time[: len(own)], inputs=test.inputs[: len(own)], readings=own)
        for test, own in zip(layout.measured.tests, np.split(shown, cuts), strict=True)
    )
    return Layout(layout.measured.with_tests(tests), layout.width, apart=layout.apart, memory=layout.memory, fine=layout.fine)


def _state_at(analysis: Analysis, states: Array, wanted: Wanted) -> Array:
    """Return the states (states,) of a measured test where a wanted one is to begin, as the model has them there."""
    layout = analysis.windows.layout
    rows = np.flatnonzero(np.repeat(layout.of_test, layout.width) == wanted.of)
    place = rows[min(wanted.start_at, len(rows) - 1)]
    begun = np.where(np.isfinite(states[place]), states[place], 0.0)
    if wanted.begun == 1.0:
        return begun
    end = np.nan_to_num(np.mean(states[rows[3 * len(rows) // 4 :]], axis=0))
    return np.asarray(np.maximum(end + wanted.begun * (begun - end), analysis.windows.lowest))


def joined_with(
    analysis: Analysis, place: Place, simulated: Windows, chosen: Sequence[int]
) -> tuple[Windows, NDArray[np.bool_]]:
    """Return windows of the measured tests, at a place, and of chosen simulated ones together, and which are new (windows,)."""
    own = analysis.windows.layout
    tests = tuple(simulated.layout.measured.tests[place] for place in chosen)
    both = analysis.measured.with_tests((*own.condensed(), *tests))
    layout = Layout(both, own.width, apart=simulated.layout.apart, memory=own.memory, fine=own.fine)
    order = np.concatenate([np.flatnonzero(simulated.layout.of_test == place) for place in chosen])
    found = _windows(analysis, layout, np.concatenate([place.starts, simulated.starts[order]]))
    for name, one in place.remembered.items():
        more = simulated.remembered.get(name, np.zeros(len(simulated.starts)))
        found.remembered[name] = np.concatenate([one, more[order]])
    return found, np.arange(len(layout.of_test)) >= len(own.of_test)
