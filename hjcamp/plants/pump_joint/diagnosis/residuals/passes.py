"""One pass over all samples for each of what is asked most often: residuals of a view, and their block means."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from hjcamp.plants.pump_joint.diagnosis.measured.signals import PERIOD, SLIDING_MARGIN, gives_way

# The push of the 16 ms before the arm moves; a difference beyond a tenth of the static friction counts little more.
LOOK_BACK = 4
SURPRISE = 0.1


@njit(cache=True, nogil=True)
def joint_errors(joint: Any, measured: Any, out: Any) -> None:
    """Fill the first two columns of ``out`` (n, channels): arm, and pressure difference, of readings ``joint`` (n, 4) less
    those ``measured`` (n, 3)."""
    for k in range(len(joint)):
        out[k, 0] = joint[k, 0] - measured[k, 0]
        out[k, 1] = (joint[k, 1] - measured[k, 1]) - (joint[k, 2] - measured[k, 2])


@njit(cache=True, nogil=True)
def line_errors(lines: Any, measured: Any, edges: Any, out: Any, at: int) -> None:
    """Fill columns ``at`` and ``at`` + 1 of ``out``: sum and difference of both pressures' errors about their mean in each
    test, the tests beginning at ``edges`` (tests + 1,)."""
    for test in range(len(edges) - 1):
        begin, end = edges[test], edges[test + 1]
        first, second = 0.0, 0.0
        for k in range(begin, end):
            first += lines[k, 1] - measured[k, 1]
            second += lines[k, 2] - measured[k, 2]
        first /= end - begin
        second /= end - begin
        for k in range(begin, end):
            one, other = lines[k, 1] - measured[k, 1] - first, lines[k, 2] - measured[k, 2] - second
            out[k, at] = one + other
            out[k, at + 1] = one - other


@njit(cache=True, nogil=True)
def force_errors(balance: Any, scale: float, slides: Any, acceleration: Any, events: Any, out: Any, at: int) -> None:
    """Fill columns ``at`` and ``at`` + 1 of ``out``, 0 before: the unexplained force where the arm ``slides``, and at the
    breakaways ``events``, from the force ``balance`` (n, 4)."""
    for k in range(len(balance)):
        if slides[k]:
            out[k, at] = scale * (balance[k, 0] - balance[k, 1] - balance[k, 3] * acceleration[k])
    for k in events:
        place = k - LOOK_BACK
        for before in range(k - LOOK_BACK + 1, k + 1):
            if abs(balance[before, 0]) > abs(balance[place, 0]):
                place = before
        static = balance[place, 2]
        most = SURPRISE * static
        out[k, at + 1] = scale * most * np.tanh((abs(balance[place, 0]) - static) / most)


@njit(cache=True, nogil=True)
def block_means(residuals: Any, starts: Any, width: int, members: Any, valid: Any) -> Any:
    """Return the sums (blocks, channels) of ``width`` samples from each of ``starts`` on over ``members``; 0 unless ``valid``."""
    out = np.zeros(members.shape)
    for block in range(len(starts)):
        for channel in range(members.shape[1]):
            if valid[block, channel]:
                total = residuals[starts[block], channel]
                for later in range(1, width):
                    total += residuals[starts[block] + later, channel]
                out[block, channel] = total / members[block, channel]
    return out


def compile_passes() -> None:
    """Compile every pass for what a diagnosis gives it, or load it."""
    readings, out, edges = np.zeros((5, 4)), np.zeros((5, 7)), np.array([0, 5])
    joint_errors(readings, readings[:, :3].copy(), out)
    line_errors(readings, readings[:, :3].copy(), edges, out, 2)
    force_errors(readings, 1.0, np.zeros(5, dtype=np.bool_), np.zeros(5), edges[:0], out, 4)
    gives_way(np.zeros(5), np.zeros(5), PERIOD, SLIDING_MARGIN)
    block_means(out, edges[:1], 5, np.ones((1, 7)), np.ones((1, 7), dtype=np.bool_))
