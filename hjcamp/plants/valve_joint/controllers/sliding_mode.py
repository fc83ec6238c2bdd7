"""Sliding mode coupled with PVA and feedforward, on two pairs of on/off valves."""

from __future__ import annotations

from typing import ClassVar

from hjcamp.model.declare.marks import part
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.valve_joint.controllers.ffwd_pva import FfwdPva
from hjcamp.plants.valve_joint.controllers.pva import differences


class SlidingMode(FfwdPva):
    r"""Feedforward and PVA, and a saturated switching term on a surface of the error.

    .. math:: s = e + \frac{2 \zeta}{\omega} d + \frac{a}{\omega^2}, \quad u_i = u_{FF,i} + u_{PVA} + k_s\,\mathrm{sat}(s / \phi)

    Thesis 2.4 couples the three and prints no equation; the form of s is that of three-mode valve control.
    """

    tuned: ClassVar[tuple[str, ...]] = ("kp", "kv", "ka", "gain", "ks", "phi", "frequency")

    kp = Parameter("1/rad", 2.3, (0.0, 1e3), text="duty for one rad of error")
    kv = Parameter("s/rad", 8e-3, (0.0, 10.0), text="duty for one rad/s")
    gain = Parameter("1", 1.47, (0.0, 10.0), text="factor on the feedforward")
    ks = Parameter("1", 0.074, (0.0, 1.0), text="duty of the switching term")
    phi = Parameter("rad", 0.0162, (1e-4, 1.0), text="width of the layer in which it is proportional")
    frequency = Parameter("rad/s", 17.0, (0.1, 1e4), text="how fast the error decays on the surface")
    damping = Parameter("1", 1.0, (0.0, 10.0), text="damping on the surface")

    @staticmethod
    def step(sample, parameter, memory):  # type: ignore[no-untyped-def]
        """Return the duties of both cylinders, and the samples for which they hold."""
        error = sample.reference - sample.arm
        slope, bend = part(differences, error, sample, memory)
        surface = error + 2.0 * parameter.damping * slope / parameter.frequency + bend / parameter.frequency**2
        duty = parameter.kp * error + parameter.kv * slope + parameter.ka * bend
        duty = duty + parameter.ks * min(max(surface / parameter.phi, -1.0), 1.0)
        return duty + sample.feedforward1, duty + sample.feedforward2, parameter.carrier_samples
