"""PRBS: two levels that change in a pseudo-random order, with smooth steps between."""

from __future__ import annotations

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.model.declare.parameter import finite_number
from hjcamp.trajectories.base import Array, Motion, Trajectory

#: Taps of shift registers of the longest sequence, by their length.
TAPS = {
    3: (3, 2),
    4: (4, 3),
    5: (5, 3),
    6: (6, 5),
    7: (7, 6),
    8: (8, 6, 5, 4),
    9: (9, 5),
    10: (10, 7),
    11: (11, 9),
    12: (12, 11, 10, 4),
}


class Prbs(Trajectory):
    r"""Levels 0 and A in the order of a shift register of ``register`` bits (period :math:`2^n - 1` bits of ``bit_time``).

    A change takes ``rise_time`` along a cycloid, :math:`x - \sin(2 \pi x) / 2 \pi`: speed and acceleration stay finite, as limits of a
    plant ask for. The power is even up to about :math:`0.44 / T_{bit}`.
    """

    amplitude_deg: float
    bit_time: float
    rise_time: float
    register: float = 7.0

    def check(self) -> None:
        number = finite_number(self.register)
        if number is None or number not in TAPS:
            raise UsageError(
                f"trajectory.register is {self.register:g}; a whole number from {min(TAPS)} to {max(TAPS)} is needed"
            )
        if self.rise_time > self.bit_time:
            raise UsageError(
                f"trajectory.rise_time is {self.rise_time:g} s, longer than trajectory.bit_time, {self.bit_time:g} s"
            )

    @property
    def bits(self) -> Array:
        """The levels of one period, 0 or 1 (2^n - 1,), the first one 0."""
        length = int(self.register)
        state, found = [1] * length, []
        for _ in range(2**length - 1):
            found.append(state[-1])
            state = [sum(state[tap - 1] for tap in TAPS[length]) % 2, *state[:-1]]
        first = found.index(0)
        return np.array(found[first:] + found[:first], dtype=float)

    def motion(self, time: Array) -> Motion:
        bits, size = self.bits, np.radians(self.amplitude_deg)
        place = (time // self.bit_time).astype(int)
        now, before = bits[place % len(bits)], bits[np.maximum(place - 1, 0) % len(bits)]
        share = np.clip((time - place * self.bit_time) / self.rise_time, 0.0, 1.0)
        step, turn = size * (now - before), 2.0 * np.pi
        moving = (share > 0.0) & (share < 1.0)
        angle = size * before + step * (share - np.sin(turn * share) / turn)
        velocity = np.where(moving, step * (1.0 - np.cos(turn * share)) / self.rise_time, 0.0)
        acceleration = np.where(moving, step * turn * np.sin(turn * share) / self.rise_time**2, 0.0)
        return angle, velocity, acceleration
