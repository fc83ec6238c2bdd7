"""Friction that changes during a test."""

from __future__ import annotations

from math import exp

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class FrictionDrift(Effect):
    r"""Static and Coulomb friction change during a test, by warming or wear, at a rate that fades.

    .. math:: F \leftarrow F\,\bigl(1 + d\,\tau\,(1 - e^{-t/\tau})\bigr)

    with t = 0 at the start of the command, where the base friction applies; the next test starts anew. A long settling
    time means a steady drift.
    Seen as: the same motion needs another force late in a test than early in it.
    Not for: change from test to test (scatter), or with rest (see static_friction_ageing).
    Source: a body that warms by its own friction, first order (Incropera & DeWitt (2002), section 5.1);
    Armstrong-Helouvry (1991), Control of Machines with Friction, chapter 4.
    """

    subsystem = "joint"
    drift = Parameter("1/s", 0.05, (-1.0, 2.0), text="share of friction gained in each second at first", off=0.0)
    settling_time = Parameter(
        "s", 10.0, (0.2, 100.0), "log-uniform", "time after which the rate has fallen to 37 %", shape=True
    )

    @staticmethod
    def friction_static(friction_static, time, drift, settling_time):
        """Static friction at this time, N."""
        return friction_static * max(0.05, 1.0 + drift * settling_time * (1.0 - exp(-time / settling_time)))

    @staticmethod
    def friction_coulomb(friction_coulomb, time, drift, settling_time):
        """Coulomb friction at this time, N."""
        return friction_coulomb * max(0.05, 1.0 + drift * settling_time * (1.0 - exp(-time / settling_time)))
