"""Viscoelastic tubing."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class TubingCreep(Effect):
    r"""The tubing goes on widening for some time after the pressure has changed.

    .. math:: \tau\,\dot V_s = (1 - \varphi)\,s\,\frac{p}{K} - V_s, \quad
              \frac{\tau}{10}\,\dot V_f = \varphi\,s\,\frac{p}{K} - V_f, \quad q_{leak} \mathrel{+}= \dot V_s + \dot V_f

    with K the line's immediate dp/dV, and the part phi of the creep a decade faster: a polymer's creep is spread over decades
    of time, for which one element for each is usual; phi = 0 is a standard linear solid. ``settled`` says how much of the
    slow part under the first pressures was over before the log began, for each test on its own: nobody waits equally long.
    Seen as: pressure that goes on falling after it rose and rising after it fell; dp/dV that is smaller in slow motion.
    Not for: water that does not come back (see leakage). Shares line_stiffness: fast motion shows K, slow K / (1 + s).
    Source: Ferry (1980), Viscoelastic Properties of Polymers, 3rd ed., chapter 3; thesis 4.4.3.
    """

    plant = "pump_joint"
    subsystem = "lines"
    share = Parameter("1", 0.15, (0.0, 3.0), text="delayed volume over immediate volume", off=0.0)
    delay = Parameter("s", 0.8, (0.02, 60.0), "log-uniform", "time constant of the slow delayed volume", shape=True)
    fast_share = Parameter("1", 0.0, (0.0, 0.9), text="part of the delayed volume that is a decade faster", shape=True)
    settled = Parameter("1", 1.0, (0.0, 1.0), text="part of the creep that was over when the log began", each_test=True)
    delayed_volume1 = State("m^3", 1e-13, 1e-9, text="slow delayed volume of line 1")
    delayed_volume2 = State("m^3", 1e-13, 1e-9, text="slow delayed volume of line 2")
    fast_volume1 = State("m^3", 1e-13, 1e-9, text="fast delayed volume of line 1")
    fast_volume2 = State("m^3", 1e-13, 1e-9, text="fast delayed volume of line 2")

    @staticmethod
    def start_delayed_volume1(pressure1, line_stiffness, share, fast_share, settled):
        """Start as far settled as ``settled`` says, m^3."""
        return settled * (1.0 - fast_share) * share * pressure1 / line_stiffness

    @staticmethod
    def start_delayed_volume2(pressure2, line_stiffness, share, fast_share, settled):
        """Start as far settled as ``settled`` says, m^3."""
        return settled * (1.0 - fast_share) * share * pressure2 / line_stiffness

    @staticmethod
    def start_fast_volume1(pressure1, line_stiffness, share, fast_share, settled):
        """Start as far settled as ten times the slow part's time has brought it, m^3."""
        return (1.0 - (1.0 - settled) ** 10.0) * fast_share * share * pressure1 / line_stiffness

    @staticmethod
    def start_fast_volume2(pressure2, line_stiffness, share, fast_share, settled):
        """Start as far settled as ten times the slow part's time has brought it, m^3."""
        return (1.0 - (1.0 - settled) ** 10.0) * fast_share * share * pressure2 / line_stiffness

    @staticmethod
    def d_delayed_volume1(pressure1, delayed_volume1, line_stiffness, share, fast_share, delay):
        """Rate of the slow delayed volume, m^3/s."""
        return ((1.0 - fast_share) * share * pressure1 / line_stiffness - delayed_volume1) / delay

    @staticmethod
    def d_delayed_volume2(pressure2, delayed_volume2, line_stiffness, share, fast_share, delay):
        """Rate of the slow delayed volume, m^3/s."""
        return ((1.0 - fast_share) * share * pressure2 / line_stiffness - delayed_volume2) / delay

    @staticmethod
    def d_fast_volume1(pressure1, fast_volume1, line_stiffness, share, fast_share, delay):
        """Rate of the fast delayed volume, m^3/s."""
        return 10.0 * (fast_share * share * pressure1 / line_stiffness - fast_volume1) / delay

    @staticmethod
    def d_fast_volume2(pressure2, fast_volume2, line_stiffness, share, fast_share, delay):
        """Rate of the fast delayed volume, m^3/s."""
        return 10.0 * (fast_share * share * pressure2 / line_stiffness - fast_volume2) / delay

    @staticmethod
    def leak1(pressure1, delayed_volume1, fast_volume1, line_stiffness, share, fast_share, delay):
        """Flow into the delayed volumes of line 1, m^3/s."""
        full = share * pressure1 / line_stiffness
        return ((1.0 - fast_share) * full - delayed_volume1 + 10.0 * (fast_share * full - fast_volume1)) / delay

    @staticmethod
    def leak2(pressure2, delayed_volume2, fast_volume2, line_stiffness, share, fast_share, delay):
        """Flow into the delayed volumes of line 2, m^3/s."""
        full = share * pressure2 / line_stiffness
        return ((1.0 - fast_share) * full - delayed_volume2 + 10.0 * (fast_share * full - fast_volume2)) / delay
