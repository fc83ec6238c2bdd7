"""Once-per-turn error of an angle sensor."""

from __future__ import annotations

from math import sin

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Eccentricity(Effect):
    r"""The disc or magnet of an angle sensor sits off the axis, so its error comes back with each turn.

    .. math:: \theta_m = \theta + e\,\bigl(\sin(\theta + \varphi) - z\,\sin\varphi\bigr)

    no error at angle 0 where the sensor was set to zero there (z = 1).
    Seen as: an angle error that depends on the angle alone, at rest and in motion, in both directions.
    Not for: an error that depends on speed (see sensor_lag) or on nothing (see sensor_offset), or of more than 0.15 rad: no disc
    turns that far off its axis, and so large a sine is any bend over the angle.
    Source: eccentricity e / R of a ring encoder, e.g. Ellin & Dolsak (2008), Sensor Review 28(2), 150-158.
    """

    acts_on = "sensor"
    only_in = {"true": ("rad",)}  # noqa: RUF012
    amplitude = Parameter("rad", 0.03, (0.0, 0.15), text="eccentricity over radius", off=0.0)
    phase = Parameter("rad", 0.0, (-3.15, 3.15), text="angle of the eccentricity", shape=True)
    zeroed = Parameter("1", 1.0, (0.0, 1.0), text="share of the error at angle 0 that was set to zero there")

    @staticmethod
    def reading(true, amplitude, phase, zeroed):
        """Error of the reading."""
        return amplitude * (sin(true + phase) - zeroed * sin(phase))
