"""Zero errors of the two pressure sensors."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class PressureOffset(Effect):
    r"""Each pressure sensor reads too much at zero pressure, and its zero may drift during a test.

    .. math:: p_{m,i} = p_i + o_i + d_i\,t

    with t = 0 at the start of the command.
    Seen as: o1 - o2 as a force that the arm does not feel, so like a friction asymmetry between the directions; a drift as a
    pressure that changes with time, whatever the motion is.
    Not for: an error that grows with pressure (see pressure_gain). o1 + o2 shows only through what depends on absolute
    pressure (entrained_air, leakage, the vapour floor); pressure that is really lost moves the arm, too (see leakage).
    Source: zero error and zero drift in a sensor's data sheet; Doebelin (2004), Measurement Systems, 5th ed., section 3.2.
    """

    plant = "pump_joint"
    subsystem = "sensors"
    offset1 = Parameter("Pa", 2e4, (-2e5, 2e5), text="reading of sensor 1 at 0 Pa gauge", off=0.0)
    offset2 = Parameter("Pa", -1e4, (-2e5, 2e5), text="reading of sensor 2 at 0 Pa gauge", off=0.0)
    drift1 = Parameter("Pa/s", 0.0, (-2e4, 2e4), text="error that sensor 1 gains in each second", off=0.0)
    drift2 = Parameter("Pa/s", 0.0, (-2e4, 2e4), text="error that sensor 2 gains in each second", off=0.0)

    @staticmethod
    def pressure1_reading(time, offset1, drift1):
        """Error of sensor 1 by now, Pa."""
        return offset1 + drift1 * max(time, 0.0)

    @staticmethod
    def pressure2_reading(time, offset2, drift2):
        """Error of sensor 2 by now, Pa."""
        return offset2 + drift2 * max(time, 0.0)
