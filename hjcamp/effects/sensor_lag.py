"""A late sensor."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class SensorLag(Effect):
    r"""A sensor reports its value late.

    .. math:: y_m = \frac{1 - \beta\,T s}{1 + (1 - \beta)\,T s}\;y

    late by T at every steady speed; a first-order lag at beta = 0, a dead time (its Pade approximant) at beta = 1/2.
    Seen as: an error in proportion to speed, with the sign of the motion.
    Not for: a late actuator (see command_delay).
    Source: first-order sensor lag, e.g. Doebelin (2004), Measurement Systems, 5th ed., section 3.3; Pade approximants of
    a dead time, e.g. Franklin, Powell & Emami-Naeini (2010), Feedback Control of Dynamic Systems, section 5.6.3.
    """

    acts_on = "sensor"
    lag = Parameter("period", 5.0, (0.1, 200.0), "log-uniform", "time by which the value is late", off=0.0)
    dead_share = Parameter("1", 0.25, (0.0, 0.5), text="0: a first-order lag, 0.5: a dead time")
    caught = State("true", 1e-5, text="value that the sensor has caught up with")

    @staticmethod
    def start_caught(true):
        """Start without error."""
        return true

    @staticmethod
    def d_caught(true, caught, lag, dead_share):
        """Rate of the value that is caught up with."""
        return (true - caught) / (lag * (1.0 - dead_share))

    @staticmethod
    def reading(reading, true, caught, dead_share):
        """Reported value."""
        return caught + dead_share / (1.0 - dead_share) * (caught - true)
