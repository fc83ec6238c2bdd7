"""A store beside one, which nothing measures."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter, State


class SecondStore(Effect):
    r"""Beside a store stands another one that nothing measures: it fills from the first, and gives back what it took.

    .. math:: q_{loss} \mathrel{+}= G\,(x - x_b), \quad \tau\,\dot x_b = x - x_b

    A wall that warms, the slow branch of a cell or a capacitor, eddy currents beside a coil, a side chamber: it holds C = G tau.
    Seen as: a level that falls or rises at first faster, later more slowly than one time constant says, after rises and falls alike.
    Not for: what does not come back (see leakage), or a reading that comes later than its level (see sensor_lag).
    Source: Foster networks, Foster (1924), Bell System Technical Journal 3(2), 259-267, doi:10.1002/j.1538-7305.1924.tb01358.x;
    of walls: Bacher & Madsen (2011), Energy and Buildings 43(7), 1511-1522, doi:10.1016/j.enbuild.2011.02.005.
    """

    acts_on = "store"
    together = True
    conductance = Parameter("loss/level", 0.1, (0.0, 100.0), text="flow for each unit by which the levels differ", off=0.0)
    delay = Parameter(
        "period",
        50.0,
        (1.0, 1e4),
        "log-uniform",
        "time in which the second level comes to meet a first one at rest",
        shape=True,
    )
    beside = State("level", 1e-5, text="level of the second store")

    @staticmethod
    def start_beside(level):
        """Start with both levels alike."""
        return level

    @staticmethod
    def d_beside(level, beside, delay):
        """Rate of the second level."""
        return (level - beside) / delay

    @staticmethod
    def loss(level, beside, conductance):
        """Flow into the second store."""
        return conductance * (level - beside)
