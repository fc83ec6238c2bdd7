"""Once-per-turn encoder error."""

from __future__ import annotations

from math import sin

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class EncoderEccentricity(Effect):
    r"""The encoder's magnet sits off the axis, so its error comes back with each turn.

    .. math:: \theta_m = \theta_a + e\,\bigl(\sin(\theta_a + \varphi) - z\,\sin\varphi\bigr)

    no error at the arm's zero where the encoder was set to zero there (z = 1).
    Seen as: an angle error that depends on arm angle alone, at rest and in motion, in both directions.
    Not for: an error that depends on speed (see encoder_lag) or none (see encoder_bias).
    Source: eccentricity e / R of a ring encoder, e.g. Ellin & Dolsak (2008), Sensor Review 28(2), 150-158; thesis 3.7.
    """

    subsystem = "sensors"
    amplitude = Parameter("rad", 0.03, (0.0, 0.4), text="eccentricity over radius", off=0.0)
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="angle of the eccentricity", shape=True)
    zeroed = Parameter("1", 1.0, (0.0, 1.0), text="share of the error at the arm's zero that was set to zero there")

    @staticmethod
    def arm_reading(arm_angle, amplitude, phase, zeroed):
        """Error of the reading, rad."""
        return amplitude * (sin(arm_angle + phase) - zeroed * sin(phase))
