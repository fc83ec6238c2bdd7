"""Three modes for on/off valves: push forwards, push backwards, or hold; decided at every sample."""

from __future__ import annotations

from typing import ClassVar

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.valve_joint.controllers.pva import differences


class ThreeMode(Controller):
    r"""All valves stay closed while a surface of the error is near 0; no pulse width modulation.

    .. math:: s = e + \frac{2 \zeta}{\omega} d + \frac{a}{\omega^2}; \quad s > \epsilon: V_1, V_4; \quad s < -\epsilon: V_2, V_3

    The law of Nguyen, Leavitt, Jabbari & Bobrow (2007), IEEE/ASME Transactions on Mechatronics, by general knowledge: the
    paper was not at hand.
    """

    samples = ("reference", "arm", "period", "index")
    results = ("duty1", "duty2", "carrier")
    tuned: ClassVar[tuple[str, ...]] = ("dead_zone", "frequency", "damping")

    dead_zone = Parameter("rad", 0.0646, (1e-4, 1.0), text="half width of the zone in which all valves are closed")
    frequency = Parameter("rad/s", 1000.0, (0.1, 1e5), text="how fast the error decays on the surface")
    damping = Parameter("1", 1.2, (0.0, 100.0), text="damping on the surface")

    begun = Memory()
    errors = Memory(size=32)

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the full duty of both cylinders in one direction, or none, for one sample."""
        error = sample.reference - sample.arm
        slope, bend = part(differences, error, sample, memory)
        surface = error + 2.0 * parameter.damping * slope / parameter.frequency + bend / parameter.frequency**2
        mode = 1.0 if surface > parameter.dead_zone else (-1.0 if surface < -parameter.dead_zone else 0.0)
        return mode, mode, 1.0
