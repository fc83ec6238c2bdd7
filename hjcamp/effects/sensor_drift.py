"""A sensor whose zero wanders."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class SensorDrift(Effect):
    r"""A sensor's zero moves in proportion to time, as it warms or its amplifier drifts.

    .. math:: y_m = y + d\,t

    with t = 0 at the start of the command.
    Seen as: an error that grows with time, whatever the motion is, and starts again with each test.
    Not for: a constant error (see sensor_offset).
    Source: zero drift in a sensor's data sheet; Doebelin (2004), Measurement Systems, 5th ed., section 3.2.
    """

    acts_on = "sensor"
    together = True
    each = ("drift",)
    drift = Parameter("reading/period", 2e-5, (-1e-2, 1e-2), text="error gained in each second", off=0.0)

    @staticmethod
    def reading(time, drift):
        """Error by now."""
        return drift * max(time, 0.0)
