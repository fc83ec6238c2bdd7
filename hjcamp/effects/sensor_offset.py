"""Constant error of a sensor."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class SensorOffset(Effect):
    r"""A sensor reads a constant too much.

    .. math:: y_m = y + o

    Seen as: a constant error. The motion shows it only through what depends on the true value.
    Not for: an error that grows with the value (see sensor_gain) or with time (see sensor_drift).
    Source: zero error in a sensor's data sheet; Doebelin (2004), Measurement Systems, 5th ed., section 3.2.
    """

    acts_on = "sensor"
    together = True
    each = ("offset",)
    offset = Parameter("reading", 0.05, (-2.0, 2.0), text="reading where the true value is 0", off=0.0)

    @staticmethod
    def reading(offset):
        """Error of the reading."""
        return offset
