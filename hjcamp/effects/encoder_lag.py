"""Late angle."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter, State


class EncoderLag(Effect):
    r"""The arm encoder reports the angle late.

    .. math:: \dot\theta_m = (\theta_a - \theta_m) / \tau

    Seen as: an angle error in proportion to speed, with the sign of the motion.
    Not for: a late pump (its delay is part of the transfer function).
    Source: first-order sensor lag, e.g. Doebelin (2004), Measurement Systems, 5th ed., section 3.3.
    """

    subsystem = "sensors"
    lag = Parameter("s", 5e-3, (1e-4, 0.2), "log-uniform", "time constant of the delay", off=0.0)
    lagged_angle = State("rad", 1e-6, 0.1, text="angle that the encoder reports")

    @staticmethod
    def start_lagged_angle(arm_angle):
        """Start without error, rad."""
        return arm_angle

    @staticmethod
    def d_lagged_angle(arm_angle, lagged_angle, lag):
        """Rate of the reported angle, rad/s."""
        return (arm_angle - lagged_angle) / lag

    @staticmethod
    def arm_reading(arm_reading, lagged_angle):
        """Reported angle, rad."""
        return lagged_angle
