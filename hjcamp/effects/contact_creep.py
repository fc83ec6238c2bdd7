"""Dry friction that rises from zero with the speed."""

from __future__ import annotations

from math import exp, log

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class ContactCreep(Effect):
    r"""A contact creeps under any push instead of sticking: friction rises from zero over a small speed.

    .. math:: f = F_c\,\mathrm{sign}(v)\,\bigl(1 - (1 - q^n)^{(|v| / v_c)^n}\bigr)^{1/n} + C_v v, \quad q = 1 - e^{-3}

    with 95 % of the friction (q) at the speed v_c, whatever the sharpness n: 1 bends from rest on, 2 is nearly a tanh.
    Seen as: a slow drift under a constant push where a dry contact would rest; no jump of the force at a reversal.
    A diagnosis does not name it: over more than a small speed this is the curve of any damper.
    Not for: what springs back at rest (see presliding), or friction that falls with speed (see stribeck_excess).
    Source: Threlfall (1978), Mechanism and Machine Theory 13(4), 475-483, doi:10.1016/0094-114X(78)90020-4; other forms:
    Pennestri et al. (2016), doi:10.1007/s11071-015-2485-3, section 2.
    """

    acts_on = "contact"
    works_on = "coulomb"
    granted = "creep_speed"
    claimed = False
    creep_speed = Parameter("speed", 0.05, (1e-4, 1.0), "log-uniform", "speed at which 95 % of the friction are there", off=0.0)
    sharpness = Parameter("1", 1.0, (0.7, 4.0), text="1: bends from rest on; 2: straight at first, nearly a tanh", shape=True)

    @staticmethod
    def locks(locks):
        """0: nothing holds the contact."""
        return 0.0 * locks

    @staticmethod
    def friction(friction, velocity, speed, direction, coulomb, creep_speed, sharpness):
        """Friction with a dry part that passes rest without a leap."""
        there = log(1.0 - (1.0 - exp(-3.0)) ** sharpness)
        share = (1.0 - exp(there * (speed / creep_speed) ** sharpness)) ** (1.0 / sharpness)
        return friction - direction * coulomb + (coulomb if velocity > 0.0 else -coulomb) * share
