"""A store that spills over its brim."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Overflow(Effect):
    r"""What rises above the brim of a store is lost.

    .. math:: q_{out} \mathrel{+}= G \max(h - h_b,\ 0)

    Seen as: a level that hardly rises above one value, whatever flows in; a temperature at which much more heat begins to be lost.
    Not for: a loss that begins at once (see leakage).
    Source: cascaded tanks with overflow: Schoukens & Noel (2017), Three Benchmarks Addressing Open Challenges in Nonlinear
    System Identification, IFAC-PapersOnLine 50(1), 446-451.
    """

    acts_on = "store"
    brim = Parameter("level", 0.8, (0.1, 10.0), "log-uniform", "level of the brim", shape=True)
    spill = Parameter("loss/level", 10.0, (0.0, 1e3), text="flow over the brim for each unit of level above it", off=0.0)

    @staticmethod
    def loss(level, brim, spill):
        """Flow over the brim."""
        return spill * max(level - brim, 0.0)
