"""What can be hidden in the two tanks: each effect in a form that the program knows and in one that no law of it has."""

from collections.abc import Callable

import numpy as np

from truth.hidden_form import Changes, Form
from truth.tanks.plant import Tanks

Build = Callable[[Tanks, float, np.random.Generator], Changes]


def _flow(share: float, tanks: Tanks) -> float:
    """Return a share of the usual flow (V/s)."""
    return share * tanks.outflow * 5.0**0.5


def _high(tanks: Tanks, place: str) -> float:
    """Return the level at which a tank stays under 4.4 V at the pump."""
    flow = 4.4 * tanks.pump
    return (flow / tanks.between if place == "upper" else flow * tanks.ratio / tanks.outflow) ** 2


def _leak(tanks: Tanks, level: float, random: np.random.Generator) -> Changes:
    return {"leak": _flow(0.1 * level, tanks) / 5.0}


def _hole(tanks: Tanks, level: float, random: np.random.Generator) -> Changes:
    return {"hole": _flow(0.2 * level, tanks), "hole_height": _high(tanks, "lower") * float(random.uniform(0.25, 0.4))}


def _brim(place: str, power: float, caught: bool = False) -> Build:
    return lambda tanks, level, random: {
        f"brim_{place}": _high(tanks, place) * float(random.uniform(0.4, 0.55)),
        "spill": 2 * tanks.between * min(level, 2.0),
        "spill_power": power,
        "caught": float(random.uniform(0.4, 0.9)) if caught else 0.0,
    }


def _exponent(tanks: Tanks, level: float, random: np.random.Generator) -> Changes:
    return {"exponent": 0.15 * level * (1.0 if random.random() < 0.7 else -1.0)}


def _laminar(tanks: Tanks, level: float, random: np.random.Generator) -> Changes:
    return {"laminar": 0.2 * level * 5.0**0.5 / tanks.outflow}


def _plain(form: str = "", kind: float = 0.0, signed: bool = False, **factors: float) -> Build:
    def build(tanks: Tanks, level: float, random: np.random.Generator) -> Changes:
        scale = level * float(random.uniform(0.85, 1.15))
        if signed and random.random() < 0.5:
            scale = -scale
        return {**{name: factor * scale for name, factor in factors.items()}, **({form: kind} if form else {})}

    return build


def _saturation(form: float) -> Build:
    return lambda tanks, level, random: {
        "saturation": {True: 3.4, False: 3.0}[level < 0.7] if level < 1.5 else 2.6,
        "saturation_form": form,
    }


def _drift(settling: bool) -> Build:
    return lambda tanks, level, random: {
        "drift": 4e-4 * level * (1.0 if random.random() < 0.5 else -1.0) * (2 if settling else 1),
        "drift_time": 900.0 if settling else 0.0,
    }


def _siphon(tanks: Tanks, level: float, random: np.random.Generator) -> Changes:
    return {
        "siphon": _flow(0.3 * level, tanks),
        "siphon_height": _high(tanks, "lower") * float(random.uniform(0.4, 0.5)),
    }


def _evaporation(tanks: Tanks, level: float, random: np.random.Generator) -> Changes:
    return {"evaporation": _flow(0.1 * level, tanks), "day": float(random.uniform(600, 1200))}


# At: where the program's plant has several places of a kind.
FORMS: tuple[Form, ...] = (
    Form("leak", "linear", _leak, ("leakage_at_lower",)),
    Form("leak", "hole", _hole, ("leakage_at_lower",), False, ("level",), ("overflow_at_lower",)),
    Form("overflow", "linear", _brim("lower", 1.0), ("overflow_at_lower",), similar=("leakage_at_lower",)),
    Form("overflow", "weir", _brim("lower", 1.5), ("overflow_at_lower",), False, ("level",), ("leakage_at_lower",)),
    Form("spill_over", "linear", _brim("upper", 1.0, True), ("spill_over",), similar=("overflow_at_upper",)),
    Form(
        "spill_over", "weir", _brim("upper", 1.5, True), ("spill_over",), False, ("level",), ("overflow_at_upper",)
    ),
    Form("flow_exponent", "power", _exponent, ("flow_exponent_at_outflow",)),
    Form("flow_exponent", "laminar", _laminar, ("flow_exponent_at_outflow",), False, ("level", "flow")),
    Form("dead_band", "hard", _plain(dead_band=0.45), ("dead_band",)),
    Form("dead_band", "soft", _plain("dead_form", 1.0, dead_band=1.0), ("dead_band",), False, ("command",)),
    Form("saturation", "hard", _saturation(0.0), ("saturation",)),
    Form("saturation", "soft", _saturation(1.0), ("saturation",), False, ("command",)),
    Form("command_delay", "dead_time", _plain(delay=14.0), ("command_delay",), similar=("sensor_lag",)),
    Form("command_delay", "two_lags", _plain("delay_form", 1.0, delay=20.0), ("command_delay",), False, ("command",), ("sensor_lag",)),
    Form("sensor_offset", "steady", _plain(signed=True, offset=0.6), ("sensor_offset",)),
    Form("sensor_offset", "fading", _plain(fading_offset=1.0), ("sensor_offset",), False, ("level",)),
    Form("sensor_gain", "steady", _plain(signed=True, gain_error=0.15), (), False, similar=("sensor_gain",), visible=False),
    Form("sensor_gain", "curved", _plain(signed=True, curvature=0.25), (), False, ("level",), ("sensor_gain", "sensor_offset")),
    Form("sensor_lag", "first_order", _plain(lag=14.0), ("sensor_lag",), similar=("command_delay",)),
    Form("sensor_lag", "second_order", _plain("lag_form", 1.0, lag=20.0), ("sensor_lag",), False, ("level",), ("command_delay",)),
    Form("sensor_drift", "linear", _drift(False), ("sensor_drift",)),
    Form("sensor_drift", "settling", _drift(True), ("sensor_drift",), False, ("time",)),
    # outside the program's library
    Form("evaporation", "with_temperature", _evaporation, (), False, ("time",)),
    Form("stirring", "sine", _plain(stirring=0.2), (), False, ("time", "level", "flow")),
    Form("clogging", "settling", _plain(clogging=0.1), (), False, ("time",)),
    Form("pump_head", "linear", _plain(head_loss=0.3), (), False, ("level", "command")),
    Form("siphon", "with_memory", _siphon, (), False, ("level", "time")),
)  # fmt: skip
