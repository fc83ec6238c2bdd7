"""Scale errors of the two pressure sensors."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class PressureGain(Effect):
    r"""Each pressure sensor has a wrong scale, which may change along its range.

    .. math:: p_{m,i} = p_i + g_i\,p_i\,(1 + b\,p_i)

    Seen as: pressure steps of one line too large against its volume, and against those of the other line.
    Not for: a constant error (see pressure_offset). With g1 = g2 line_stiffness and all friction scale by one factor.
    Source: sensitivity error and nonlinearity (a parabola through the ends of the range) in a sensor's data sheet; Doebelin
    (2004), Measurement Systems, 5th ed., section 3.2.
    """

    plant = "pump_joint"
    subsystem = "sensors"
    error1 = Parameter("1", 0.08, (-0.6, 1.5), text="scale error of sensor 1", off=0.0)
    error2 = Parameter("1", -0.05, (-0.6, 1.5), text="scale error of sensor 2", off=0.0)
    bend = Parameter("1/Pa", 0.0, (-3e-6, 3e-6), text="share by which the scale error grows with pressure")

    @staticmethod
    def pressure1_reading(pressure1, error1, bend):
        """Error of sensor 1, Pa."""
        return error1 * pressure1 * (1.0 + bend * pressure1)

    @staticmethod
    def pressure2_reading(pressure2, error2, bend):
        """Error of sensor 2, Pa."""
        return error2 * pressure2 * (1.0 + bend * pressure2)
