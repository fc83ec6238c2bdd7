"""PVA plus the duties that a model of valves and racks asks for along the reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.valve_joint.controllers.pva import Pva

LEAST_DROP_PA = 1e3


class FfwdPva(Pva):
    r"""The PVA law with a model-based feedforward added to both duties.

    .. math:: F_d = m \ddot y_d + F_c\,\mathrm{sign}\,\dot y_d + C_v \dot y_d, \quad
              p_{1,2} = \frac{p_s}{2} \pm \frac{F_d}{2 A_2}, \quad u_i = u_{PVA} + g \frac{A_2 \dot y_d}{C \sqrt{\Delta p_i}}

    with the drop over the valve that is open: inlet 1 and outlet 4 forwards, outlet 2 and inlet 3 backwards. The reference is
    taken half a carrier period and a dead time ahead. The Coulomb friction of its model is not the joint's, so that there is
    something to be robust against. Thesis 2.4 names the law; the equations are those of `ValveJoint`, inverted.
    """

    tuned: ClassVar[tuple[str, ...]] = ("kp", "kv", "ka", "gain")

    kp = Parameter("1/rad", 3.3, (0.0, 1e3), text="duty for one rad of error")
    ka = Parameter("s^2/rad", 5.7e-5, (0.0, 1.0), text="duty for one rad/s^2")
    gain = Parameter("1", 1.67, (0.0, 10.0), text="factor on the feedforward: short pulses lose water to compression")
    model_coulomb = Parameter("N", 1.22, (0.0, 60.0), text="Coulomb friction of its model: the new joint's first state (4.5.1)")

    @classmethod
    def plan(
        cls, reference: NDArray[np.float64], parameter: Mapping[str, float], plant: Mapping[str, float], period: float
    ) -> NDArray[np.float64]:
        """Return the feedforward duties of both cylinders (n, 2)."""
        lead = round(0.5 * parameter["carrier_samples"] + plant["opening_delay"] / period)
        ahead = np.concatenate([reference[:, 1:3], np.zeros((lead, 2))])[lead:] * plant["pinion_radius"]
        velocity, acceleration = ahead.T
        force = plant["moving_mass"] * acceleration + plant["viscous"] * velocity
        force += parameter["model_coulomb"] * np.sign(velocity)
        half, supply = 0.5 * force / plant["joint_area"], plant["supply"]
        above = np.column_stack([supply / 2 - half, supply / 2 - half - plant["return_pressure"]])
        below = np.column_stack([supply / 2 + half - plant["return_pressure"], supply / 2 + half])
        drops = np.maximum(np.where(velocity[:, None] >= 0.0, above, below), LEAST_DROP_PA)
        flow = plant["joint_area"] * velocity[:, None]
        return np.asarray(parameter["gain"] * flow / (plant["conductance"] * np.sqrt(drops)))
