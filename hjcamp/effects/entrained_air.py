"""Air bubbles in a liquid."""

from __future__ import annotations

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class EntrainedAir(Effect):
    r"""Bubbles in the liquid make a store softer at low pressure.

    .. math:: \frac{1}{K} = \frac{1}{K_0} + \frac{V_a p_{atm}}{(p + p_{atm})^2}

    with p the gauge pressure and V_a the air of one store at atmospheric pressure, compressed isothermally.
    Seen as: a rise of pressure per volume that falls with pressure; a mean pressure far from the usual one shows it.
    Not for: stores whose level is no pressure.
    Source: Merritt (1967), Hydraulic Control Systems, section 2.2 (effective bulk modulus).
    """

    acts_on = "store"
    together = True
    only_in = {"level": ("Pa",)}  # noqa: RUF012
    air_volume = Parameter("Pa/stiffness", 1e5, (0.0, 1e7), text="air of one store at atmospheric pressure", off=0.0)

    @staticmethod
    def stiffness(stiffness, level, air_volume):
        """Give the stiffness with bubbles."""
        absolute = max(level + 101325.0, 1000.0)
        return stiffness / (1.0 + stiffness * air_volume * 101325.0 / (absolute * absolute))
