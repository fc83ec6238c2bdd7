"""Friction that changes during a test."""

from __future__ import annotations

from math import exp

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter, State


def drifted(friction, time, travelled, drift, settling_time, pace):
    """Return the friction by now."""
    progress = max(time, 0.0) + travelled / pace
    return friction * max(0.05, 1.0 + drift * settling_time * (1.0 - exp(-progress / settling_time)))


class FrictionDrift(Effect):
    r"""Friction changes during a test, by warming or wear, at a rate that fades.

    .. math:: F \leftarrow F\,\bigl(1 + d\,\tau\,(1 - e^{-q/\tau})\bigr), \quad
              C_v \leftarrow C_v\,\bigl(1 + d_v\,\tau\,(1 - e^{-q/\tau})\bigr), \quad q = t + s / v_0

    with F static and Coulomb, C_v viscous friction, t = 0 at the start of the command, where the base friction applies, and
    s the travel since then; the next test starts again. A pace v_0 far above the speeds of the test: it goes with time; far
    below: with the travel alone. A long settling time: a steady drift.
    Seen as: the same motion needs another force late in a test than early in it.
    Not for: change from test to test (scatter), or with rest (see static_friction_ageing).
    Source: a body that warms by its own friction, first order (Incropera & DeWitt (2002), section 5.1);
    Armstrong-Helouvry (1991), Control of Machines with Friction, chapter 4.
    """

    acts_on = "contact"
    drift = Parameter("1/period", 5e-5, (-1e-3, 2e-3), text="share of dry friction gained in each second at first", off=0.0)
    viscous_drift = Parameter(
        "1/period", 0.0, (-1e-3, 2e-3), text="share of viscous friction gained in each second at first", off=0.0
    )
    settling_time = Parameter(
        "period", 1e4, (200.0, 1e5), "log-uniform", "time after which the rate has fallen to 37 %", shape=True
    )
    pace = Parameter("speed", 50.0, (0.05, 50.0), "log-uniform", "speed at which travel counts as much as time", shape=True)
    travelled = State("travel", text="travel since the start of the command")
    last_position = State("travel", text="place one sample ago")

    @staticmethod
    def start_last_position(travel):
        """Start where it is."""
        return travel

    @staticmethod
    def next_travelled(travelled, last_position, travel, time):
        """Add the way since the last sample."""
        return travelled + abs(travel - last_position) if time > 0.0 else 0.0

    @staticmethod
    def next_last_position(travel):
        """Keep this position."""
        return travel

    @staticmethod
    def static(static, time, travelled, drift, settling_time, pace):
        """Static friction by now."""
        return part(drifted, static, time, travelled, drift, settling_time, pace)

    @staticmethod
    def coulomb(coulomb, time, travelled, drift, settling_time, pace):
        """Coulomb friction by now."""
        return part(drifted, coulomb, time, travelled, drift, settling_time, pace)

    @staticmethod
    def viscous(viscous, time, travelled, viscous_drift, settling_time, pace):
        """Viscous friction by now."""
        return part(drifted, viscous, time, travelled, viscous_drift, settling_time, pace)
