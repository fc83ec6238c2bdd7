"""Viscoelastic tubing."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class TubingCreep(Effect):
    r"""The tubing goes on widening for some time after the pressure has changed.

    .. math:: \tau\,\dot V_c = s\,\frac{p}{K} - V_c, \quad q_{leak} \mathrel{+}= \dot V_c

    with K the line's immediate dp/dV: a standard linear solid. ``settled`` says how much of the creep under the first
    pressures was over before the log began, for each test on its own: nobody waits equally long.
    Seen as: pressure that goes on falling after it rose and rising after it fell; dp/dV that is smaller in slow motion.
    Not for: water that does not come back (see leakage). Shares line_stiffness: fast motion shows K, slow K / (1 + s).
    Source: Ferry (1980), Viscoelastic Properties of Polymers, 3rd ed., chapter 3; thesis 4.4.3.
    """

    subsystem = "lines"
    share = Parameter("1", 0.15, (0.0, 3.0), text="delayed volume over immediate volume", off=0.0)
    delay = Parameter("s", 0.8, (0.02, 60.0), "log-uniform", "time constant of the delayed volume", shape=True)
    settled = Parameter("1", 1.0, (0.0, 1.0), text="part of the creep that was over when the log began", each_test=True)
    delayed_volume1 = State("m^3", 1e-13, 1e-9, text="delayed volume of line 1")
    delayed_volume2 = State("m^3", 1e-13, 1e-9, text="delayed volume of line 2")

    @staticmethod
    def start_delayed_volume1(pressure1, line_stiffness, share, settled):
        """Start as far settled as ``settled`` says, m^3."""
        return settled * share * pressure1 / line_stiffness

    @staticmethod
    def start_delayed_volume2(pressure2, line_stiffness, share, settled):
        """Start as far settled as ``settled`` says, m^3."""
        return settled * share * pressure2 / line_stiffness

    @staticmethod
    def d_delayed_volume1(pressure1, delayed_volume1, line_stiffness, share, delay):
        """Rate of the delayed volume, m^3/s."""
        return (share * pressure1 / line_stiffness - delayed_volume1) / delay

    @staticmethod
    def d_delayed_volume2(pressure2, delayed_volume2, line_stiffness, share, delay):
        """Rate of the delayed volume, m^3/s."""
        return (share * pressure2 / line_stiffness - delayed_volume2) / delay

    @staticmethod
    def leak1(pressure1, delayed_volume1, line_stiffness, share, delay):
        """Flow into the delayed volume of line 1, m^3/s."""
        return (share * pressure1 / line_stiffness - delayed_volume1) / delay

    @staticmethod
    def leak2(pressure2, delayed_volume2, line_stiffness, share, delay):
        """Flow into the delayed volume of line 2, m^3/s."""
        return (share * pressure2 / line_stiffness - delayed_volume2) / delay
