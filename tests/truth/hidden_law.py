"""The laws that an effect of the pump joint can follow: the first is the one that it always had, the others are asked for."""

from collections.abc import Callable

import numpy as np

from truth.hidden import Changes


def _orifice(changes: Changes) -> Changes:
    # as much flow at the old blend's pressure, 0.2 MPa
    flow = changes["cross_conductance"] / 2**0.5
    return {"cross_conductance": flow * (1 + 0.2e6 / 2e3) ** 0.5, "cross_turbulent_pressure": 2e3}


def _tube_orifice(changes: Changes) -> Changes:
    # as much loss at 0.14 mL/s, a sine of 60 deg at 0.5 Hz
    return {"tube_resistance": 0.0, "tube_orifice": changes["tube_resistance"] / 1.4e-7}


def _plain_leak(changes: Changes) -> Changes:
    return {"leak_conductance": 3 * changes["leak_conductance"], "leak_gap_growth": 0.0}


LAWS: dict[str, dict[str, Callable[[Changes], Changes]]] = {
    "stribeck_friction": {"hyperbolic": lambda changes: {}, "exponential": lambda changes: {"weakening_form": 1.0}},
    "position_friction": {"harmonics": lambda changes: {}, "bump": lambda changes: {"angle_form": 1.0}},
    "leakage": {"gap": lambda changes: {}, "laminar": _plain_leak},
    "cross_leakage": {
        "blend": lambda changes: {},
        "laminar": lambda changes: {"cross_turbulent_pressure": 1e12},
        "orifice": _orifice,
    },
    "line_resistance": {"laminar": lambda changes: {}, "orifice": _tube_orifice},
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
