"""Constant error of a pressure sensor."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class PressureOffset(Effect):
    r"""Each pressure sensor reads a constant too much.

    .. math:: p_{m,i} = p_i + o_i

    Seen as: o1 - o2 as a force that the arm does not feel, so like a friction asymmetry between the directions.
    Not for: an error that grows with pressure (see pressure_gain). o1 + o2 shows only through what depends on absolute
    pressure (entrained_air, leakage, the vapour floor).
    Source: zero error in a sensor's data sheet; Doebelin (2004), Measurement Systems, 5th ed., section 3.2.
    """

    subsystem = "sensors"
    offset1 = Parameter("Pa", 2e4, (-2e5, 2e5), text="reading of sensor 1 at 0 Pa gauge", off=0.0)
    offset2 = Parameter("Pa", -1e4, (-2e5, 2e5), text="reading of sensor 2 at 0 Pa gauge", off=0.0)

    @staticmethod
    def pressure1_reading(offset1):
        """Error of sensor 1, Pa."""
        return offset1

    @staticmethod
    def pressure2_reading(offset2):
        """Error of sensor 2, Pa."""
        return offset2
