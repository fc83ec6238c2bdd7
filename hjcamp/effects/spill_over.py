"""A store that spills into the one below."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class SpillOver(Effect):
    r"""What rises above the brim of a store runs over, and part of it falls into the store below.

    .. math:: q_{out} \mathrel{+}= G \max(h - h_b,\ 0), \quad q_{in,below} \mathrel{+}= c\,G \max(h - h_b,\ 0)

    Seen as: a level that hardly rises above one value, and at the same time a level below that rises faster.
    Not for: a store whose spill is lost whole (see overflow).
    Source: cascaded tanks with overflow: Schoukens & Noel (2017), Three Benchmarks Addressing Open Challenges in Nonlinear
    System Identification, IFAC-PapersOnLine 50(1), 446-451.
    """

    acts_on = "store"
    brim = Parameter("level", 0.8, (0.1, 10.0), "log-uniform", "level of the brim", shape=True)
    spill = Parameter("loss/level", 10.0, (0.0, 1e3), text="flow over the brim for each unit of level above it", off=0.0)
    caught = Parameter("1", 0.5, (0.0, 1.0), text="share of it that the store below catches")

    @staticmethod
    def loss(level, brim, spill):
        """Flow over the brim."""
        return spill * max(level - brim, 0.0)

    @staticmethod
    def loss_below(level, brim, spill, caught):
        """What the store below loses less."""
        return -caught * spill * max(level - brim, 0.0)
