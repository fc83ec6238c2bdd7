"""PVA: position, velocity and acceleration of the error drive two pairs of on/off valves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter


def differences(error, sample, memory):  # type: ignore[no-untyped-def]
    """Return the first and second differences of the error over 10 samples; before the first sample it did not change."""
    if memory.begun == 0.0:
        memory.begun = 1.0
        for past in range(32):
            memory.errors[past] = error
    place = int(sample.index) % 32
    memory.errors[place] = error
    before = memory.errors[(place + 22) % 32]
    earlier = memory.errors[(place + 12) % 32]
    span = 10.0 * sample.period
    slope = (error - before) / span
    bend = (error - 2.0 * before + earlier) / (span * span)
    return slope, bend


class Pva(Controller):
    r"""Duty of two valve pairs from the error and its first two differences over n = 10 samples.

    .. math:: u = K_p e + K_v d + K_a a, \quad d_k = \frac{e_k - e_{k-n}}{n t_s}, \quad a_k = \frac{d_k - d_{k-n}}{n t_s}

    The text names the law (thesis 2.4) and prints no gain. It has no integral. Duties hold for one ``carrier`` period.
    """

    samples = ("reference", "arm", "feedforward1", "feedforward2", "period", "index")
    results = ("duty1", "duty2", "carrier")
    planned = ("feedforward1", "feedforward2")
    tuned: ClassVar[tuple[str, ...]] = ("kp", "kv", "ka")

    kp = Parameter("1/rad", 5.6, (0.0, 1e3), text="duty for one rad of error")
    kv = Parameter("s/rad", 0.0126, (0.0, 10.0), text="duty for one rad/s")
    ka = Parameter("s^2/rad", 5e-5, (0.0, 1.0), text="duty for one rad/s^2")
    carrier_samples = Parameter("1", 16.0, (1.0, 1000.0), text="samples of one period of the pulse width modulation")

    begun = Memory()
    errors = Memory(size=32)

    @classmethod
    def plan(
        cls, reference: NDArray[np.float64], parameter: Mapping[str, float], plant: Mapping[str, float], period: float
    ) -> NDArray[np.float64]:
        """Return no feedforward (n, 2)."""
        return np.zeros((len(reference), 2))

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the duties of both cylinders, and the samples for which they hold."""
        error = sample.reference - sample.arm
        slope, bend = part(differences, error, sample, memory)
        duty = parameter.kp * error + parameter.kv * slope + parameter.ka * bend
        return duty + sample.feedforward1, duty + sample.feedforward2, parameter.carrier_samples
