"""The windows in which a model of any plant is held against its tests: their length and their initial states."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.hidden_states import begin_hidden
from hjcamp.diagnosis.calibration.multistart import best_begun
from hjcamp.diagnosis.data.segments import SHORTEST_OF_ALL, Layout
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.estimation.gauss_newton import Free, settled
from hjcamp.diagnosis.residuals.initial_states import estimated
from hjcamp.diagnosis.residuals.kernels import Kernels
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.diagnosis.validation.blocks import FEWEST
from hjcamp.errors import UsageError
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]


# Of what a start brings, at the end of a window over that in its first half: a constant jerk makes it 8; more grows by itself.
MOST_GROWTH = 10.0


# Of a plant with few states a start brings no more than a power of the time; what it grows by itself beyond that is less than this.
OWN_GROWTH = math.e


# Samples that are looked at: time and memory do not grow with the length of the logs.
MOST_SAMPLES = {"quick": 12_000, "standard": 32_000, "thorough": 10_000_000}


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
        # on its way a fit may come where friction chatters
        found.spare(candidate)
        fitted = settled(found, candidate, free)
        found.usual_steps = 0.0
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
    fitted = settled(own, base, free)
    known = best_begun(own, base, fitted, plant.base_parameters).candidate if np.isfinite(fitted.loss) else base
    memory = replace(windows, layout=replace(layout, memory=1)).memory(known)
    if memory <= layout.width or len(layout.of_test) * layout.width < FEWEST * memory:
        return windows
    return replace(windows, layout=replace(layout, memory=memory))


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
