"""Multisine: several frequencies at once, with phases that keep its peaks low."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.model.declare.parameter import finite_number
from hjcamp.trajectories.base import Array, Motion, Trajectory

MOST_LINES = 200
#: Samples in a period of the highest line: between them a sum is at most 1 / cos(pi / POINTS) of what it is at them
#: (Ehlich and Zeller 1964).
POINTS = 64
#: Peaks are cut at this share, so often.
CUT, ROUNDS = 0.85, 200


class Multisine(Trajectory):
    r"""Sum of ``lines`` sines of one amplitude at whole multiples of the first frequency, spread evenly up to the last.

    .. math:: \theta = a \sum_k \bigl(\sin(2 \pi f_k t + \varphi_k) - \sin \varphi_k\bigr), \quad |\theta| \le A

    Phases begin as Schroeder's (doi:10.1109/TIT.1970.1054411); cutting peaks while amplitudes stay (Van der Ouderaa 1988,
    doi:10.1109/19.7420) brings the crest factor of ten lines below 1.8 (a sine: 1.41). It starts at 0.
    """

    amplitude_deg: float
    first_hz: float
    last_hz: float
    lines: float = 10.0

    def check(self) -> None:
        number = finite_number(self.lines)
        if number is None or number != int(number) or not 2 <= number <= MOST_LINES:
            raise UsageError(f"trajectory.lines is {self.lines:g}; a whole number from 2 to {MOST_LINES} is needed")
        if len(self.frequencies) < number:
            most = max(int(self.last_hz / self.first_hz), 0)
            raise UsageError(
                f"trajectory.lines is {self.lines:g}; between {self.first_hz:g} and {self.last_hz:g} Hz there are {most} multiples "
                "of the first"
            )

    @property
    def frequencies(self) -> Array:
        """The frequencies of the lines (n,), Hz."""
        return self.first_hz * np.unique(
            np.rint(np.linspace(1.0, float(int(self.last_hz / self.first_hz + 1e-9)), int(self.lines)))
        )

    @cached_property
    def _phases(self) -> Array:
        """The phases of the lines (n,), rad: Schroeder's, then those of the sum with its peaks cut, again; the best."""
        harmonics = np.rint(self.frequencies / self.first_hz).astype(int)
        places = np.arange(len(harmonics))
        phases = best = -np.pi * places * (places + 1) / len(places)
        least, number = np.inf, POINTS * int(harmonics[-1])
        for _ in range(ROUNDS):
            spectrum = np.zeros(number // 2 + 1, dtype=complex)
            spectrum[harmonics] = -1j * np.exp(1j * phases)
            found = np.fft.irfft(spectrum, number)
            peak = float(np.abs(found).max())
            least, best = (peak, phases) if peak < least else (least, best)
            phases = np.angle(1j * np.fft.rfft(np.clip(found, -CUT * peak, CUT * peak))[harmonics])
        return best

    @property
    def crest_factor(self) -> float:
        """The peak over the rms of the sum of sines, without what brings its start to 0."""
        found = self._sum(self._period())[0]
        return float(np.abs(found).max() / np.sqrt(np.mean(found**2)))

    def motion(self, time: Array) -> Motion:
        start = self._sum(np.zeros(()))[0]
        size = np.radians(self.amplitude_deg) * np.cos(np.pi / POINTS) / np.abs(self._sum(self._period())[0] - start).max()
        angle, velocity, acceleration = self._sum(time)
        return size * (angle - start), size * velocity, size * acceleration

    def _period(self) -> Array:
        number = POINTS * round(float(self.frequencies[-1]) / self.first_hz)
        return np.arange(number) / (number * self.first_hz)

    def _sum(self, time: Array) -> Motion:
        """Return the sum of sines of amplitude 1, and its two rates."""
        angle, velocity, acceleration = (np.zeros(np.shape(time)) for _ in range(3))
        for frequency, shift in zip(self.frequencies, self._phases, strict=True):
            speed = 2.0 * np.pi * frequency
            phase = speed * time + shift
            angle += np.sin(phase)
            velocity += speed * np.cos(phase)
            acceleration -= speed**2 * np.sin(phase)
        return angle, velocity, acceleration
