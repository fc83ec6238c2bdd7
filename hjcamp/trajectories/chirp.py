"""Chirp: a sine whose frequency rises."""

from __future__ import annotations

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.trajectories.base import Array, Motion, Trajectory


class Chirp(Trajectory):
    r"""Sine about 0 whose frequency goes from the first to the last, by equal factors in equal times; it starts at full speed.

    .. math:: \theta = A \sin \varphi, \quad \varphi = 2 \pi f_0 \frac{k^t - 1}{\ln k}, \quad k = (f_1 / f_0)^{1 / T}

    The power lies evenly over the logarithm of frequency.
    """

    amplitude_deg: float
    first_hz: float
    last_hz: float

    def check(self) -> None:
        if self.first_hz == self.last_hz:
            raise UsageError(f"trajectory.last_hz is {self.last_hz:g} Hz, as the first; kind sine is a sine of one frequency")

    def motion(self, time: Array) -> Motion:
        amplitude, rate = np.radians(self.amplitude_deg), np.log(self.last_hz / self.first_hz) / self.duration
        speed = 2.0 * np.pi * self.first_hz * np.exp(rate * time)
        phase = (speed - 2.0 * np.pi * self.first_hz) / rate
        sine, cosine = np.sin(phase), np.cos(phase)
        return amplitude * sine, amplitude * speed * cosine, amplitude * (rate * speed * cosine - speed**2 * sine)
