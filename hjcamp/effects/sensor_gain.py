"""Scale error of a sensor."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class SensorGain(Effect):
    r"""A sensor has a wrong scale.

    .. math:: y_m = (1 + g)\,y

    Seen as: an error in proportion to the value, the same whatever the speed.
    Not for: a constant error (see sensor_offset).
    Source: sensitivity error in a sensor's data sheet; Doebelin (2004), Measurement Systems, 5th ed., section 3.2.
    """

    acts_on = "sensor"
    together = True
    each = ("gain_error",)
    gain_error = Parameter("1", 0.05, (-0.6, 1.5), text="scale error", off=0.0)

    @staticmethod
    def reading(true, gain_error):
        """Error of the reading."""
        return gain_error * true
