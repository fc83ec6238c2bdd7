"""A force that is put on a body and taken off again."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class ForceStep(Effect):
    r"""A constant force pushes a body from one time to another: a weight on a thread that is hung on and taken off.

    .. math:: F \mathrel{+}= F_0 \quad \text{where } t_0 \le t < t_1

    with t = 0 at the start of the command; each edge falls on the sample at which the time has been reached.
    Seen as: a displacement that lasts as long as the force, less what friction holds.
    Not for: a force that is always there (see constant_force), or one that changes with the place (see gravity_load).
    Source: static compliance of a machine from a dead weight, e.g. ISO 9283:1998, Manipulating industrial robots (static compliance).
    """

    acts_on = "body"
    strength = Parameter("force", 1.0, (-20.0, 20.0), text="the force, positive in the positive direction", off=0.0)
    begin = Parameter("s", 0.2, (0.0, 3600.0), text="time at which it is put on")
    end = Parameter("s", 1.2, (0.0, 3600.0), text="time at which it is taken off")

    @staticmethod
    def force(time, strength, begin, end):
        """The force while it is on."""
        return strength if begin <= time < end else 0.0
