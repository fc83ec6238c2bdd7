"""Air bubbles in the water."""

from __future__ import annotations

from hjcamp.model.effect import Effect
from hjcamp.model.parameter import Parameter


class EntrainedAir(Effect):
    r"""Bubbles in a line make it softer at low pressure.

    .. math:: \frac{1}{K} = \frac{1}{K_0} + \frac{V_a p_{atm}}{(p + p_{atm})^2}

    with V_a the air of one line at atmospheric pressure, compressed isothermally.
    Seen as: dp/dV that falls with pressure; a preload far from the usual one shows it.
    Not for: delayed extra volume (see tubing_creep).
    Source: thesis 4.4.3.4 - 4.4.3.6, 4.4.3.14.
    """

    subsystem = "lines"
    air_volume = Parameter(
        "m^3", 8.5e-9, (0.0, 3e-7), text="air of one line at atmospheric pressure (0.5 %: 8.5 mm3)", off=0.0
    )

    @staticmethod
    def stiffness1(stiffness1, pressure1, air_volume):
        """Give dp/dV of line 1 with its bubbles, Pa/m^3."""
        absolute = max(pressure1 + 101325.0, 1000.0)
        return stiffness1 / (1.0 + stiffness1 * air_volume * 101325.0 / (absolute * absolute))

    @staticmethod
    def stiffness2(stiffness2, pressure2, air_volume):
        """Give dp/dV of line 2 with its bubbles, Pa/m^3."""
        absolute = max(pressure2 + 101325.0, 1000.0)
        return stiffness2 / (1.0 + stiffness2 * air_volume * 101325.0 / (absolute * absolute))
