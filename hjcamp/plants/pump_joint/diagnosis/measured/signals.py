"""What one test's readings say of its motion: smoothed travel, rest, breakaways, and where a contact only gives way."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
STRIDE = 4
PERIOD = STRIDE * 1e-3
REST_SPEED = 0.6e-3
SLIDING_MARGIN = 5
# Up to 240 ms after the arm first moves its contact may only give way; as it begins to slide the push falls within 48 ms.
ONSET, FALLS_WITHIN, FALLS_TO = 60, 12, 0.85
# Until then it is slow, and no seal gives way over a millimetre; a place that holds a moving arm is none of that.
CREEPS, MOST_TRAVEL = 0.6, 1e-3


def smooth(values: Array, half: int) -> Array:
    """Return the centred moving mean over 2 half + 1 samples; the ends repeat their value."""
    padded = np.concatenate([np.full(half, values[0]), values, np.full(half, values[-1])])
    total = np.cumsum(np.concatenate([[0.0], padded]))
    width = 2 * half + 1
    return (total[width:] - total[:-width]) / width


def slider_motion(arm: Array, pulley_radius: float, stride: int = 1) -> tuple[Array, Array, Array]:
    """Return the sliders' travel, velocity and acceleration, SI, of every ``stride``-th sample of the counted arm angle at
    1 kHz (n,), rad.

    A parabola over 41 samples (Savitzky & Golay 1964, doi:10.1021/ac60214a047); velocity is 0 where the count rests.
    """
    kernels = np.array(_parabola_kernels())[:, ::-1]
    half = kernels.shape[1] // 2
    padded = np.pad(arm * pulley_radius, half, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, kernels.shape[1])[::stride]
    travel, velocity, acceleration = kernels @ windows.T
    now = np.arange(0, len(arm), stride)
    ahead, behind, here = arm[np.minimum(now + 15, len(arm) - 1)], arm[np.maximum(now - 15, 0)], arm[now]
    resting = (np.abs(ahead - here) < 1e-9) & (np.abs(here - behind) < 1e-9) | (np.abs(velocity) < REST_SPEED)
    return travel, np.where(resting, 0.0, velocity), acceleration


def misfit_of(arm: Array, travel: Array, values: Mapping[str, float]) -> Array:
    """Return the distance (n,) of the counted arm angle from the smooth travel, in counts."""
    return (arm - travel / values["pulley_radius"]) / values["encoder_count"]


def breakaways(arm: Array, count: float) -> NDArray[np.int64]:
    """Return the coarse samples (events,) at which the counted arm angle (rad, 1 kHz) changes after 120 ms of rest.

    A flicker of the count is not a breakaway: the arm must be six counts further on 60 ms later.
    """
    changes = np.flatnonzero(np.diff(arm)) + 1
    rests = np.diff(np.concatenate([[0], changes])) >= 120
    found = [k for k in changes[rests] if 60 < k < len(arm) - 60 and abs(arm[k + 60] - arm[k - 1]) > 5.5 * count]
    return np.array(found, dtype=np.int64) // STRIDE


def yielding(velocity: Array, push: Array) -> NDArray[np.bool_]:
    """Return where the arm moves while its contact only gives way (n,): slowly, up to the peak of the push from which it falls.

    ``velocity`` (n,) in m/s and ``push`` (n,) in any unit, positive in the same direction; coarse samples.
    """
    return np.asarray(gives_way(velocity, push, PERIOD, SLIDING_MARGIN))


@functools.cache
def _parabola_kernels() -> tuple[Array, Array, Array]:
    # scipy.signal.savgol_coeffs, without the half second that its import takes
    steps = np.arange(-20, 21, dtype=np.float64)[::-1] ** np.arange(3)[:, None]
    wanted = np.diag([1.0, 1.0 / 1e-3, 2.0 / 1e-3**2])
    rows = [np.asarray(np.linalg.lstsq(steps, one)[0], dtype=np.float64) for one in wanted]
    return rows[0], rows[1], rows[2]


@njit(cache=True, nogil=True)
def gives_way(velocity: Any, push: Any, period: float, margin: int) -> Any:
    """Return where an arm creeps up to the peak of a push that then falls (n,): see `yielding`."""
    n = len(velocity)
    found = np.zeros(n, dtype=np.bool_)
    begin = 0
    while begin < n:
        sign, end = np.sign(velocity[begin]), begin + 1
        while end < n and np.sign(velocity[end]) == sign:
            end += 1
        if sign != 0.0:
            peak = begin
            for k in range(begin + 1, min(begin + ONSET, end)):
                if push[k] * sign > push[peak] * sign:
                    peak = k
            travel, slow, fast, least = 0.0, 0.0, 0.0, push[peak] * sign
            for k in range(begin, peak + 1):
                travel += period * abs(velocity[k])
            for k in range(begin, max(peak - margin, begin + 1)):
                slow = max(slow, abs(velocity[k]))
            for k in range(peak, min(peak + FALLS_WITHIN, end)):
                fast, least = max(fast, abs(velocity[k])), min(least, push[k] * sign)
            creeps = slow < CREEPS * fast and travel < MOST_TRAVEL
            if creeps and push[peak] * sign > 0.0 and least < FALLS_TO * push[peak] * sign:
                found[begin : peak + margin + 1] = True
        begin = end
    return found
