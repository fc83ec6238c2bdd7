"""Friction that grows with what loads a contact."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class LoadFriction(Effect):
    r"""Static and Coulomb friction grow with the load on a contact: the weight carried, a gear's torque, a seal's pressure.

    .. math:: F \mathrel{+}= c\,|L|

    with L the load that the plant gives to the contact; the base friction is that without it.
    Seen as: more friction where the load is large, in both directions of motion and of load.
    Not for: tests at one load, where the base friction takes it up.
    Source: Bittencourt & Gunnarsson (2012), Static Friction in a Robot Joint - Modeling and Identification of Load and
    Temperature Effects, Journal of Dynamic Systems, Measurement, and Control 134(5), 051013.
    """

    acts_on = "contact"
    coefficient = Parameter("coulomb/load", 0.2, (0.0, 5.0), text="friction for each unit of load", off=0.0)

    @staticmethod
    def static(load, coefficient):
        """Static friction added by the load."""
        return coefficient * abs(load)

    @staticmethod
    def coulomb(load, coefficient):
        """Coulomb friction added by the load."""
        return coefficient * abs(load)
