"""Tests simulated from their first sample on, whatever windows they are judged by: what grows slowly shows nowhere else."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Whole:
    r"""What a model errs by over whole tests: rms (sensors,), SI, and the share :math:`1 - \sum e^2 / \sum (y - \bar y)^2` of each
    test's spread that it explains (sensors,).
    """

    rms: Array
    explained: Array


def through(windows: Windows) -> Windows:
    """Return windows of the same tests, all of them, in which each test begins once, as its first window does."""
    old = windows.layout
    layout = replace(old, share=1.0, apart=False, memory=len(old.readings))
    starts = np.tile(windows.sizes, (len(layout.of_test), 1))
    # the first window of a test is always looked at
    new, first = (one.begins[:: one.width] == 1 for one in (layout, old))
    starts[new] = windows.starts[first]
    remembered = {name: np.zeros(len(starts)) for name in windows.remembered}
    for name, one in remembered.items():
        one[new] = windows.remembered[name][first]
    return replace(windows, layout=layout, starts=starts, slides=None, remembered=remembered)


def whole_errors(windows: Windows, candidate: Candidate) -> tuple[Layout, Array, int] | None:
    """Return the layout of whole tests, what a model errs by over them (n, sensors), SI, each begun where it fits best, and its memory
    in samples.

    None where tests are simulated through anyway, and where the model diverges, is driven and does not forget its start (a position
    that a force moves) or is held by a loop outside its equations: what adds up by chance, and what the loop hides, is no error of a
    model.
    """
    measured = windows.layout.measured
    if windows.layout.memory or measured.plant.loop == "foreign":
        return None
    driven = any(np.ptp(test.inputs, axis=0).any() for test in measured.tests)
    own = through(windows)
    with np.errstate(over="ignore", invalid="ignore"):
        own.move_starts(candidate)
        memory = own.memory(candidate)
        errors = own.errors(candidate)
        forgets = memory < np.median(own.layout.counts) * own.layout.width
        return (own.layout, errors, memory) if forgets or (not driven and np.isfinite(errors).all()) else None


def whole_error(windows: Windows, candidate: Candidate) -> Whole | None:
    """Return the error of a model over whole tests; None where these are not looked at, see `whole_errors`."""
    found = whole_errors(windows, candidate)
    if found is None:
        return None
    layout, errors, _ = found
    with np.errstate(over="ignore", invalid="ignore"):
        squares = np.mean(errors**2, axis=0)
    spread = np.mean((layout.readings - layout.means) ** 2, axis=0)
    return Whole(np.sqrt(squares), 1.0 - squares / np.maximum(spread, 1e-300))
