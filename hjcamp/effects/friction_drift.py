"""Friction that changes during a test."""

from __future__ import annotations

from math import exp

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class FrictionDrift(Effect):
    r"""Static and Coulomb friction change during a test, by warming or wear, at a rate that fades.

    .. math:: F \leftarrow F\,\bigl(1 + d\,\tau\,(1 - e^{-q/\tau})\bigr), \quad q = t + s / v_0

    with t = 0 at the start of the command, where the base friction applies, and s the travel since then; the next test
    starts anew. A pace v_0 far above the speeds of the test: it goes with time; far below: with the travel alone. A long
    settling time: a steady drift.
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
    pace = Parameter("m/s", 1.0, (1e-3, 1.0), "log-uniform", "speed at which travel counts as much as time", shape=True)
    travelled = State("m", 1e-6, 0.01, text="travel since the start of the command")
    last_position = State("m", 1e-6, 0.01, text="travel of the sliders one sample ago")

    @staticmethod
    def start_last_position(slider_position):
        """Start where the sliders are, m."""
        return slider_position

    @staticmethod
    def next_travelled(travelled, last_position, slider_position, time):
        """Add the way since the last sample, m."""
        return travelled + abs(slider_position - last_position) if time > 0.0 else 0.0

    @staticmethod
    def next_last_position(slider_position):
        """Keep this position, m."""
        return slider_position

    @staticmethod
    def friction_static(friction_static, time, travelled, drift, settling_time, pace):
        """Static friction by now, N."""
        progress = max(time, 0.0) + travelled / pace
        return friction_static * max(0.05, 1.0 + drift * settling_time * (1.0 - exp(-progress / settling_time)))

    @staticmethod
    def friction_coulomb(friction_coulomb, time, travelled, drift, settling_time, pace):
        """Coulomb friction by now, N."""
        progress = max(time, 0.0) + travelled / pace
        return friction_coulomb * max(0.05, 1.0 + drift * settling_time * (1.0 - exp(-progress / settling_time)))
