"""Late angle."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class EncoderLag(Effect):
    r"""The arm encoder reports the angle late.

    .. math:: \theta_m = \frac{1 - \beta\,T s}{1 + (1 - \beta)\,T s}\;\theta_a

    late by T at every steady speed; a first-order lag at beta = 0, a dead time (its Pade approximant) at beta = 1/2.
    Seen as: an angle error in proportion to speed, with the sign of the motion.
    Not for: a late pump (its delay is part of the transfer function).
    Source: first-order sensor lag, e.g. Doebelin (2004), Measurement Systems, 5th ed., section 3.3; Pade approximants of
    a dead time, e.g. Franklin, Powell & Emami-Naeini (2010), Feedback Control of Dynamic Systems, section 5.6.3.
    """

    subsystem = "sensors"
    lag = Parameter("s", 5e-3, (1e-4, 0.2), "log-uniform", "time by which the angle is late", off=0.0)
    dead_share = Parameter("1", 0.25, (0.0, 0.5), text="0: a first-order lag, 0.5: a dead time")
    lagged_angle = State("rad", 1e-6, 0.1, text="angle that the encoder has caught up with")

    @staticmethod
    def start_lagged_angle(arm_angle):
        """Start without error, rad."""
        return arm_angle

    @staticmethod
    def d_lagged_angle(arm_angle, lagged_angle, lag, dead_share):
        """Rate of the angle that is caught up with, rad/s."""
        return (arm_angle - lagged_angle) / (lag * (1.0 - dead_share))

    @staticmethod
    def arm_reading(arm_reading, arm_angle, lagged_angle, dead_share):
        """Reported angle, rad."""
        return lagged_angle + dead_share / (1.0 - dead_share) * (lagged_angle - arm_angle)
