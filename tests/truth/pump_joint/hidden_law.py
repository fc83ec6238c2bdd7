"""The laws that an effect of the pump joint can follow: the first is the one that it always had, the others are asked for."""

from collections.abc import Callable

import numpy as np

from truth.pump_joint.hidden import Changes


def _orifice(changes: Changes) -> Changes:
    # as much flow at the old blend's pressure, 0.2 MPa
    flow = changes["cross_conductance"] / 2**0.5
    return {"cross_conductance": flow * (1 + 0.2e6 / 2e3) ** 0.5, "cross_turbulent_pressure": 2e3}


def _rough_tube(changes: Changes) -> Changes:
    # as much loss at 0.14 mL/s, a sine of 60 deg at 0.5 Hz
    return {"tube_resistance": 0.0, "tube_turbulence": changes["tube_resistance"] / 1.4e-7**0.75}


def _plain_leak(changes: Changes) -> Changes:
    return {"leak_conductance": 3 * changes["leak_conductance"], "leak_gap_growth": 0.0}


def _power_creep(changes: Changes) -> Changes:
    # two times that lie as far apart as those of a power law over the tests
    return {"creep_fast_share": 0.5, "creep_fast_ratio": 15.0, "creep_time": 2 * changes["creep_time"]}


def _hardening(changes: Changes) -> Changes:
    # as stiff as the linear one under 6 N
    return {"string_hardening": 6.0 / changes["string_stiffness"] / 0.5**0.5}


LAWS: dict[str, dict[str, Callable[[Changes], Changes]]] = {
    "stribeck_friction": {"hyperbolic": lambda changes: {}, "exponential": lambda changes: {"weakening_form": 1.0}},
    "position_friction": {"harmonics": lambda changes: {}, "bump": lambda changes: {"angle_form": 1.0}},
    "leakage": {"gap": lambda changes: {}, "laminar": _plain_leak},
    "cross_leakage": {
        "blend": lambda changes: {},
        "laminar": lambda changes: {"cross_turbulent_pressure": 1e12},
        "orifice": _orifice,
    },
    "line_resistance": {"laminar": lambda changes: {}, "turbulent": _rough_tube},
    "pump_backlash": {"even": lambda changes: {}, "worn": lambda changes: {"backlash_form": 1.0}},
    "entrained_air": {"isothermal": lambda changes: {}, "adiabatic": lambda changes: {"air_exponent": 1.4}},
    "tubing_creep": {"two_times": lambda changes: {}, "broad": _power_creep},
    "pressure_friction": {"proportional": lambda changes: {}, "flattening": lambda changes: {"seal_form": 1.0}},
    "static_friction_ageing": {"logarithmic": lambda changes: {}, "squeezed": lambda changes: {"ageing_form": 1.0}},
    "friction_drift": {"warming": lambda changes: {}, "wear": lambda changes: {"warming_form": 1.0}},
    "string_elasticity": {"linear": lambda changes: {}, "hardening": _hardening},
    "encoder_eccentricity": {"once": lambda changes: {}, "oval": lambda changes: {"disc_form": 1.0}},
    "encoder_lag": {"dead_time": lambda changes: {}, "averaging": lambda changes: {"encoder_form": 1.0}},
    "pressure_offset": {"constant": lambda changes: {}, "fading": lambda changes: {"offset_fading": 0.15}},
    "pressure_gain": {"even": lambda changes: {}, "bent": lambda changes: {"gain_form": 0.5}},
    "stray_spring": {"linear": lambda changes: {}, "cubic": lambda changes: {"spring_form": 1.0}},
}


def chosen_law(effect: str, form: str | None, seed: int) -> str:
    """Return the law of an effect, "" where it has one only; raises ValueError for one that no effect has."""
    known = list(LAWS.get(effect, {}))
    if form not in (None, "random", *(name for laws in LAWS.values() for name in laws)):
        raise ValueError(f"form {form!r}: known are random, {', '.join(sorted({n for v in LAWS.values() for n in v}))}")
    if not known:
        return ""
    if form == "random":
        return known[int(np.random.default_rng([seed, 113, list(LAWS).index(effect)]).integers(len(known)))]
    return form if form in known else known[0]


def with_law(effect: str, law: str, changes: Changes) -> Changes:
    """Return the changes of an effect under one of its laws."""
    return changes | LAWS[effect][law](changes) if law else changes
