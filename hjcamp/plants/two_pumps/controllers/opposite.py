"""Two pumps with one command and opposite signs: nobody looks after the mean pressure."""

from __future__ import annotations

from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.two_pumps.controllers.sum_difference import SumDifference


class Opposite(SumDifference):
    r"""The law of one pump, given to two with opposite signs (thesis 6.4).

    .. math:: \theta_1 = u, \quad \theta_2 = -u

    With equal pumps it is the one-pump joint. The lines begin at a mean of 0.26 MPa, the preload of 5.2.5.
    """

    regulate = Parameter("1", 0.0, (0.0, 1.0), text="1 would regulate the mean pressure")
    mean = Parameter("Pa", 0.26e6, (0.0, 2e6), text="mean pressure at the start (5.2.5)")
