"""The model-based feedforward: what the pump must do so that a model's arm follows the reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.run.simulator import PERIOD, Simulator

Array = NDArray[np.float64]
LEAST_PRESSURE_STEP = 5e3


@dataclass(frozen=True)
class Feedforward:
    """How the feedforward is formed: its gain, and whether the static friction is pushed against at rest.

    Both variants of the reference are settings of it: the design of 5.3.1 (gain 1, static friction at rest) and that of
    the experiments, 5.3.3 (gain 1.23, no static part, the friction of the positive direction for both).
    """

    gain: float = 1.0
    static_friction: bool = True
    friction_direction: str = "reference"

    def command(
        self,
        model: Simulator,
        values: dict[str, float],
        reference: Array,
        pressures: tuple[float, float],
        direction: float,
    ) -> Array:
        r"""Return the pump command (n,), rad, for ``reference`` (n, 3): arm angle, velocity, acceleration.

        .. math:: F = m\ddot y + f(\dot y) - F_{load}, \quad
                  \Delta V = \frac{F / A_2 - (p_1 - p_2)}{K_1 + K_2} , \quad
                  \theta_f = g\,\frac{\Delta V + A_2 \Delta y}{A_1 l}

        with friction, mass, load, dp/dV and losses those of ``model`` along the reference. At rest the push keeps the
        last commanded ``direction``. Source: thesis 5.3.1.1 - 5.3.1.5; for other models its own equations, inverted.
        """
        p = model.vector(values)
        position = {name: index for index, name in enumerate(model.composition.parameters)}
        if self.friction_direction == "positive":
            for kind in ("static", "coulomb", "viscous"):
                p[position[f"{kind}_negative"]] = p[position[f"{kind}_positive"]]
        constant = dict(zip(position, p, strict=True))
        names = (
            "mass",
            "friction",
            "friction_static",
            "load_force",
            "stiffness1",
            "stiffness2",
            "leak1",
            "leak2",
            "cross_flow",
        )
        place = model.signals(names)
        radius, area = constant["pulley_radius"], constant["joint_area"]
        z = model.begin({"pressure1": pressures[0], "pressure2": pressures[1]}, p)
        at = {name: index for index, name in enumerate(model.states)}
        u = model.inputs()
        out = np.zeros(len(model.composition.vocabulary.signals))
        command = np.zeros(len(reference))
        volume, push = 0.0, None
        for k, (angle, velocity, acceleration) in enumerate(reference):
            moving = velocity != 0.0 or acceleration != 0.0
            if velocity != 0.0:
                direction = 1.0 if velocity > 0.0 else -1.0
            z[at["slider_position"]] = angle * radius
            z[at["slider_velocity"]] = velocity * radius
            model.kernel.signals(k * PERIOD, direction, z, u, p, out)
            mass, friction, static, load, k1, k2, leak1, leak2, cross = out[place]
            if moving or push is None:
                push = mass * acceleration * radius + (friction if moving else 0.0) - load
            if not moving and self.static_friction:
                push = direction * static - load
            lost = 0.5 * (leak1 + leak2) * PERIOD
            z[at["pressure1"]] -= k1 * lost
            z[at["pressure2"]] -= k2 * lost
            missing = push / area - (z[at["pressure1"]] - z[at["pressure2"]])
            # A reversal turns the whole friction round in one sample; stiffness that varies wants small steps.
            parts = int(abs(missing) / LEAST_PRESSURE_STEP) + 1
            for part in range(parts):
                if part:
                    model.kernel.signals(k * PERIOD, direction, z, u, p, out)
                    k1, k2 = out[place[4]], out[place[5]]
                change = missing / parts / (k1 + k2)
                z[at["pressure1"]] += k1 * change
                z[at["pressure2"]] = max(z[at["pressure2"]] - k2 * change, constant["vapour_pressure"])
                volume += change
            volume += (cross + 0.5 * (leak1 - leak2)) * PERIOD
            command[k] = (volume + area * angle * radius) / constant["pump_area"]
        return self.gain * command / constant["pump_lead"]
