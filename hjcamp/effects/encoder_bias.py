"""Constant angle error."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class EncoderBias(Effect):
    r"""The arm encoder was set to zero at a wrong angle.

    .. math:: \theta_m = \theta_a + b

    Seen as: a constant angle error. The motion shows it only through what depends on the true angle
    (gravity_load, position_friction), or where the true angle at the start is known.
    Not for: an error that changes with the angle (see encoder_eccentricity).
    Source: thesis 3.7 (incremental encoder, zero set before each test).
    """

    subsystem = "sensors"
    bias = Parameter("rad", 0.02, (-0.4, 0.4), text="reading at true angle 0", off=0.0)

    @staticmethod
    def arm_reading(bias):
        """Error of the reading, rad."""
        return bias
