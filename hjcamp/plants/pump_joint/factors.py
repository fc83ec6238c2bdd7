"""Factors of the rig: by how much its pump, controller and procedure differ from what their groups say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.pump_joint.loop import ClosedLoop
from hjcamp.plants.pump_joint.procedure import Procedure


def _factor(low: float, high: float, text: str) -> Parameter:
    return Parameter("1", 1.0, (low, high), "log-uniform", text)


#: What the text leaves open or may have misprinted; a model gives them as ``factors``. 1 is what the groups say, or ``off``.
FACTORS: dict[str, Parameter] = {
    "controller_scale": _factor(0.1, 4.0, "factor on the scale of the PID output (E8)"),
    "derivative_gain": _factor(0.1, 4.0, "factor on Kd (5.2.1)"),
    "integral_gain": _factor(0.2, 4.0, "factor on Ki (5.2.1)"),
    "feedforward_gain": _factor(0.4, 1.6, "factor on the feedforward of 5.3.3 (E9)"),
    "pump_bandwidth": _factor(0.4, 3.0, "factor on the speed of the pump's poles (4.3.4)"),
    "pump_latency": _factor(0.2, 8.0, "factor on the pump's delay (4.3.4)"),
    "pump_ratio": _factor(0.6, 1.6, "factor on the volume that the pump moves (bores, lead)"),
    "head_start": _factor(0.2, 3.0, "factor on the initial pressure differences (5.2.4.1)"),
    "bumpless": Parameter("1", 1.0, (0.0, 1.0), text="share of the integral's jump that is absent (E10)", off=0.0),
}
#: Powers of the pump's speed in the coefficients of its transfer function.
OF_BANDWIDTH = {"pump_gain": 3, "pump_a2": 1, "pump_a1": 2, "pump_a0": 3}


def changed_values(values: Mapping[str, float], factors: Mapping[str, float]) -> dict[str, float]:
    """Return the plant parameters (SI, by name) with the factors of the pump applied."""
    found = dict(values)
    speed = factors.get("pump_bandwidth", 1.0)
    for name, power in OF_BANDWIDTH.items():
        found[name] = found[name] * speed**power
    found["pump_delay"] = found["pump_delay"] * factors.get("pump_latency", 1.0)
    found["pump_area"] = found["pump_area"] * factors.get("pump_ratio", 1.0)
    return found


def changed_loop(test: ClosedLoop, law: type[Controller], factors: Mapping[str, float]) -> ClosedLoop:
    """Return the closed loop with the factors of controller, feedforward and procedure applied; factors a law lacks do nothing."""
    control, procedure, reference = test.control.copy(), test.procedure.copy(), test.reference.copy()
    named = {"scale": "controller_scale"}
    named |= {
        f"{side}_{gain}": name
        for side in ("positive", "negative")
        for gain, name in (("kd", "derivative_gain"), ("ki", "integral_gain"))
    }
    for place, gain in enumerate(law.parameters):
        control[place] *= factors.get(named.get(gain, ""), 1.0)
        if gain == "bumpless":
            control[place] += factors.get(gain, 0.0) * (1.0 - control[place])
    procedure[list(Procedure.parameters).index("difference")] *= factors.get("head_start", 1.0)
    reference[:, 3] *= factors.get("feedforward_gain", 1.0)
    return replace(test, control=control, procedure=procedure, reference=reference)
