"""Laws of motion from rest to rest, on normalised time and travel, for the kinds to share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hjcamp.trajectories.base import Array, Motion


def linear(fraction: Array) -> Motion:
    """Return travel s = x, its first and second derivative; x is time over rise time, within [0, 1]."""
    return fraction, np.ones_like(fraction), np.zeros_like(fraction)


def cycloid(fraction: Array) -> Motion:
    r"""Return the cycloidal travel and its first and second derivative (thesis 5.2.5, trajectory e).

    .. math:: s = x - \sin(2 \pi x) / (2 \pi)

    x is time over rise time, within [0, 1]; velocity and acceleration are 0 at both ends.
    """
    turn = 2.0 * np.pi * fraction
    return fraction - np.sin(turn) / (2.0 * np.pi), 1.0 - np.cos(turn), 2.0 * np.pi * np.sin(turn)


LAWS: dict[str, Callable[[Array], Motion]] = {"cycloid": cycloid, "linear": linear}


def rise(law: Callable[[Array], Motion], time: Array, rise_time: float, travel: float) -> Motion:
    """Return angle, velocity and acceleration of one rise of ``travel`` (rad) in ``rise_time`` (s), then rest."""
    position, slope, curvature = law(np.clip(time / rise_time, 0.0, 1.0))
    moving = time < rise_time
    return (
        travel * position,
        np.where(moving, travel / rise_time * slope, 0.0),
        np.where(moving, travel / rise_time**2 * curvature, 0.0),
    )
