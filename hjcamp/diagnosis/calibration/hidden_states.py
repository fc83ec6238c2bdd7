"""Initial states that nothing measures: where the model leads them from the window before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.residuals.initial_states import estimated
from hjcamp.diagnosis.residuals.windows import FARTHEST_MOVED, Windows
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]


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


def completed_states(windows: Windows, candidate: Candidate) -> Array:
    """Return the states (n, states) with what nothing measures as the model has it."""
    joined = windows.layout.joined(estimated(windows.layout.measured)[0])
    if np.all(np.isfinite(joined)):
        return joined
    passed = windows.readings(candidate)[1]
    return np.where(np.isfinite(joined), joined, passed)
