"""What differs from test to test on a rig where nothing is missing: friction, pressures, rest, noise."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

PROFILE_POINTS = 241


@dataclass(frozen=True)
class Scatter:
    """Standard deviations: friction between tests and along the travel (shares), pressures and noise in Pa."""

    friction_between: float = 0.02
    friction_direction: float = 0.01
    friction_within: float = 0.025
    initial_pressure: float = 4e3
    white_noise: float = 500.0
    slow_noise: float = 500.0
    hum: float = 100.0


@dataclass(frozen=True)
class TestDraw:
    """One test's draw of everything that scatters."""

    profile: np.ndarray
    directions: np.ndarray
    pressures: np.ndarray
    noise: np.ndarray
    counts: np.ndarray
    waiting_time: float
    previous_rest: float
    start_travel: float
    start_in_play: float


def draw_test(seed: int, condition: int, repetition: int, samples: int, scatter: Scatter) -> TestDraw:
    """Draw the scatter of one test; it does not depend on what is hidden in the rig."""
    random = np.random.default_rng([seed, 107, condition, repetition])
    between = random.normal(0, scatter.friction_between)
    directions = between + random.normal(0, scatter.friction_direction, 2)
    rough = gaussian_filter1d(random.normal(size=PROFILE_POINTS), 5.0)
    profile = scatter.friction_within * rough / rough.std()
    pressures = random.normal(0, scatter.initial_pressure, 2)
    counts = random.uniform(0, 1, 2)
    waiting, rest = random.uniform(1, 10), np.exp(random.uniform(np.log(5), np.log(60)))
    travel = random.normal(0, 2e-5)
    in_play = random.uniform(-1, 1)
    white = random.normal(0, scatter.white_noise, (samples, 2))
    memory = np.exp(-1 / 5)
    drive = random.normal(0, scatter.slow_noise * np.sqrt(1 - memory**2), (samples, 2))
    slow = lfilter([1.0], [1.0, -memory], drive, axis=0)
    hum = scatter.hum * np.sin(2 * np.pi * 50e-3 * np.arange(samples) + random.uniform(0, 2 * np.pi))
    noise = white + slow + np.sqrt(2) * hum[:, None]
    return TestDraw(profile, directions, pressures, noise, counts, float(waiting), float(rest), float(travel), float(in_play))
