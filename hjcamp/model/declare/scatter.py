"""How one repetition differs from the next: friction, initial pressures, sensor noise, all from the test's seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scatter:
    """Standard deviations of a rig's repetitions; friction is relative, pressures in Pa, the correlation time in s."""

    friction_between: float = 0.03
    friction_within: float = 0.03
    friction_correlation: float = 0.2
    initial_pressure: float = 3e3


@dataclass(frozen=True)
class FrictionScatter:
    """How friction differs from test to test and within one: relative standard deviations and correlation time, s."""

    between: float = 0.0
    within: float = 0.0
    correlation: float = 0.2

    def factors(self, generator: np.random.Generator, samples: int, period: float) -> Array:
        """Return the factor on static and Coulomb friction at each sample (samples,)."""
        between = np.exp(self.between * generator.standard_normal())
        return np.asarray(between * np.exp(self.within * coloured(generator, samples, self.correlation / period)))


@dataclass(frozen=True)
class Draw:
    """What one seed gives for one test: factors on friction (n), noise (n, channels), offsets of pressures, counts."""

    friction: Array
    noise: Array
    pressures: Array
    phases: Array


def coloured(generator: np.random.Generator, samples: int, correlation: float, rows: int | None = None) -> Array:
    """Return (samples,) of a stationary first-order process of unit variance; ``correlation`` in samples.

    With ``rows`` only so many of them, drawn as if all were.
    """
    # x_k - keep x_k-1 = kick_k as a triangular system: scipy.signal.lfilter, without the half second that its import takes
    from scipy.linalg.lapack import dtbtrs

    keep = float(np.exp(-1.0 / max(correlation, 1e-9)))
    start = generator.standard_normal()
    kicks: Array = generator.standard_normal(samples)[:rows] * np.sqrt(1.0 - keep**2)
    if not len(kicks):
        return kicks
    kicks[0] += keep * start
    bands = np.ones((2, len(kicks)), order="F")
    bands[1] = -keep
    return np.asarray(dtbtrs(bands, kicks, uplo="L", diag="U")[0])


def draw(seed: int, samples: int, noise: Array, scatter: Scatter, period: float = 1e-3, rows: int | None = None) -> Draw:
    """Draw one test; ``noise`` (channels,) holds the standard deviation of each analog channel, 0 for the others.

    With ``rows`` only the first of the samples, equal bit for bit to those of a whole draw.
    """
    generator = np.random.default_rng(seed)
    between = np.exp(scatter.friction_between * generator.standard_normal())
    within = coloured(generator, samples, scatter.friction_correlation / period, rows)
    friction = between * np.exp(scatter.friction_within * within)
    pressures = scatter.initial_pressure * generator.standard_normal(2)
    phases = generator.uniform(0.0, 1.0, len(noise))
    return Draw(friction, generator.standard_normal((len(friction), len(noise))) * noise, pressures, phases)
