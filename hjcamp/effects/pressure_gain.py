"""Scale error of a pressure sensor."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class PressureGain(Effect):
    r"""Each pressure sensor has a wrong scale.

    .. math:: p_{m,i} = (1 + g_i)\,p_i

    Seen as: pressure steps of one line too large against its volume, and against those of the other line.
    Not for: a constant error (see pressure_offset). With g1 = g2 line_stiffness and all friction scale alike.
    Source: sensitivity error in a sensor's data sheet; Doebelin (2004), Measurement Systems, 5th ed., section 3.2.
    """

    subsystem = "sensors"
    error1 = Parameter("1", 0.08, (-0.6, 1.5), text="scale error of sensor 1", off=0.0)
    error2 = Parameter("1", -0.05, (-0.6, 1.5), text="scale error of sensor 2", off=0.0)

    @staticmethod
    def pressure1_reading(pressure1, error1):
        """Error of sensor 1, Pa."""
        return error1 * pressure1

    @staticmethod
    def pressure2_reading(pressure2, error2):
        """Error of sensor 2, Pa."""
        return error2 * pressure2
