"""What can be hidden in the linear axis: each effect in a form that the program knows and in one that no law of it has."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from truth.axis.plant import LIMIT_VOLT, Axis
from truth.hidden_form import Changes, Form

Build = Callable[[tuple[Axis, "Use"], float, np.random.Generator], Changes]


class Use(NamedTuple):
    """How the axis is used: stroke about 0 (m), highest speed (m/s) and acceleration (m/s^2), length of the logs (s)."""

    stroke: float
    speed: float
    acceleration: float
    duration: float


def _coulomb(axis: Axis) -> float:
    return 0.5 * (axis.coulomb_positive + axis.coulomb_negative)


def _typical(axis: Axis, use: Use) -> float:
    """Return the force of a usual move (N)."""
    return _coulomb(axis) + 0.5 * axis.viscous_positive * use.speed + 0.4 * axis.mass * use.acceleration


def _sign(random: np.random.Generator) -> float:
    return 1.0 if random.random() < 0.5 else -1.0


def _stribeck(form: float) -> Build:
    def build(machine, level, random):
        axis, use = machine
        speed = use.speed * float(random.uniform(0.04, 0.12))
        return {"excess": 0.45 * level * _coulomb(axis), "fall_speed": speed, "fall_form": form}

    return build


def _place_friction(form: float) -> Build:
    def build(machine, level, random):
        _, use = machine
        share = min(0.25 * level, 0.7)
        if form == 0.0:
            length = use.stroke * float(random.uniform(0.3, 1.1))
            return {"place_share": share, "place_length": length, "place_phase": float(random.uniform(0, 2 * math.pi))}
        spot = use.stroke * float(random.uniform(-0.3, 0.3))
        width = use.stroke * float(random.uniform(0.05, 0.12))
        return {"place_share": 2 * share, "place_length": width, "place_phase": spot, "place_form": 1.0}

    return build


def _asymmetry(kind: str) -> Build:
    def build(machine, level, random):
        axis, use = machine
        share = min(0.12 * level, 0.5) * _sign(random)
        if kind == "late":
            return {"late_asymmetry": 1.5 * share, "asymmetry_speed": use.speed * float(random.uniform(0.1, 0.3))}
        if kind == "viscous":
            share *= 2
        names = (f"{kind}_positive", f"{kind}_negative")
        return {name: getattr(axis, name) * (1 + sign * share) for name, sign in zip(names, (1, -1), strict=True)}

    return build


def _steady(cable: bool) -> Build:
    def build(machine, level, random):
        axis, use = machine
        force = 0.2 * level * _coulomb(axis) * _sign(random)
        return {
            "steady_force": force,
            "cable_length": 0.5 * use.stroke * float(random.uniform(0.9, 1.3)) if cable else 0.0,
        }

    return build


def _spring(form: float) -> Build:
    def build(machine, level, random):
        axis, use = machine
        length = 0.5 * use.stroke * (1.0 if form == 1.0 else 0.35)
        reach = 0.35 * level * _typical(axis, use)
        centre = use.stroke * float(random.uniform(-0.15, 0.15))
        stiffness = reach / (length if form else 0.5 * use.stroke)
        return {"spring": stiffness, "spring_centre": centre, "spring_length": length, "spring_form": form}

    return build


def _drag(power: float) -> Build:
    def build(machine, level, random):
        axis, use = machine
        return {"drag": 0.35 * level * _typical(axis, use) / use.speed**power, "drag_power": power}

    return build


def _delay(form: float) -> Build:
    return lambda machine, level, random: {
        "delay": 5e-3 * min(level, 1.6) * float(random.uniform(0.9, 1.2)),
        "delay_form": form,
    }


def _dead_band(form: float) -> Build:
    def build(machine, level, random):
        axis, use = machine
        width = 0.25 * level * _typical(axis, use) / axis.gain
        return {"dead_band": width * float(random.uniform(0.8, 1.2)), "dead_form": form}

    return build


def _saturation(form: float) -> Build:
    def build(machine, level, random):
        axis, use = machine
        most = _coulomb(axis) + axis.viscous_positive * use.speed + axis.mass * use.acceleration
        share = {True: 0.9, False: 0.75}[level < 0.7] if level < 1.5 else 0.6
        return {"saturation": min(share * most / axis.gain, LIMIT_VOLT), "saturation_form": form}

    return build


def _lag(form: float) -> Build:
    return lambda machine, level, random: {
        "sensor_lag": 5e-3 * min(level, 1.6) * float(random.uniform(0.9, 1.2)),
        "sensor_form": form,
    }


def _play(form: float) -> Build:
    return lambda machine, level, random: {
        "play": 2.5e-3 * level * machine[1].stroke * float(random.uniform(0.8, 1.2)),
        "play_form": form,
    }


def _presliding(law: float) -> Build:
    return lambda machine, level, random: {
        "law": law,
        "grain": 1.5e-3 * level * machine[1].stroke * float(random.uniform(0.8, 1.2)),
    }


def _warming(form: float) -> Build:
    def build(machine, level, random):
        _, use = machine
        share = 0.25 * min(level, 2.0) * (-1.0 if random.random() < 0.7 else 1.0)
        way = 0.3 * use.speed * use.duration
        if form == 0.0:
            return {"warming": share, "warming_time": use.duration * float(random.uniform(0.3, 0.6))}
        return {"warming": 0.8 * share, "warming_travel": way, "warming_form": 1.0}

    return build


def _ripple(share: float, with_speed: bool) -> Build:
    def build(machine, level, random):
        axis, use = machine
        return {
            "ripple": share * level * _coulomb(axis),
            "ripple_length": use.stroke * float(random.uniform(0.12, 0.3)),
            "ripple_phase": float(random.uniform(0, 2 * math.pi)),
            "ripple_speed": 0.5 * use.speed if with_speed else 0.0,
        }

    return build


def _pitch(machine, level, random):
    axis, use = machine
    length = use.stroke * float(random.uniform(0.12, 0.3))
    # as large as the force of its false acceleration is 0.3 of a usual one
    turn = 2 * math.pi * use.speed / length
    amplitude = 0.3 * level * _typical(axis, use) / (axis.mass * turn**2)
    return {"pitch_error": amplitude, "ripple_length": length, "ripple_phase": float(random.uniform(0, 2 * math.pi))}


def _plain(**factors: float) -> Build:
    return lambda machine, level, random: {name: factor * level for name, factor in factors.items()}


def _placed(machine, level, random):
    axis, use = machine
    return {"placed_mass": 0.35 * level * axis.mass, "placed_at": use.duration * float(random.uniform(0.35, 0.65))}


def _swinging(machine, level, random):
    axis, _ = machine
    return {"swinging_mass": 0.2 * min(level, 1.6) * axis.mass, "swing_frequency": float(random.uniform(2.5, 5.0))}


def _vibration(machine, level, random):
    axis, use = machine
    return {"vibration": 0.15 * level * _typical(axis, use), "vibration_frequency": float(random.uniform(3.0, 9.0))}


def _speed_loss(machine, level, random):
    return {"speed_loss": 0.25 * min(level, 2.0) / machine[1].speed}


FORMS: tuple[Form, ...] = (
    Form("stribeck", "exponential", _stribeck(0.0), ("stribeck_excess",)),
    Form("stribeck", "hyperbolic", _stribeck(1.0), ("stribeck_excess",), False),
    Form("position_friction", "sine", _place_friction(0.0), ("position_friction",)),
    Form("position_friction", "bump", _place_friction(1.0), ("position_friction",), False, ("position",)),
    Form("asymmetry", "coulomb", _asymmetry("coulomb"), ("coulomb_asymmetry",), similar=("constant_force",)),
    Form("asymmetry", "viscous", _asymmetry("viscous"), ("viscous_asymmetry",)),
    Form(
        "asymmetry", "late", _asymmetry("late"), ("coulomb_asymmetry",), False, ("direction", "velocity"),
        ("viscous_asymmetry", "constant_force"),
    ),
    Form("constant_force", "slope", _steady(False), ("constant_force",), similar=("coulomb_asymmetry",)),
    Form("constant_force", "cable", _steady(True), ("constant_force",), False, ("position",), ("coulomb_asymmetry",)),
    Form("spring", "linear", _spring(0.0), ("spring",)),
    Form("spring", "cubic", _spring(1.0), ("cubic_spring",)),
    Form("spring", "softening", _spring(2.0), ("spring",), False, ("position",)),
    Form("quadratic_drag", "square", _drag(2.0), ("quadratic_drag",)),
    Form("quadratic_drag", "power", _drag(2.7), ("quadratic_drag",), False, ("velocity",)),
    Form("command_delay", "dead_time", _delay(0.0), ("command_delay",), similar=("sensor_lag",)),
    Form("command_delay", "two_lags", _delay(1.0), ("command_delay",), False, ("command",), ("sensor_lag",)),
    Form("dead_band", "hard", _dead_band(0.0), ("dead_band",)),
    Form("dead_band", "soft", _dead_band(1.0), ("dead_band",), False, ("command",)),
    Form("saturation", "hard", _saturation(0.0), ("saturation",)),
    Form("saturation", "soft", _saturation(1.0), ("saturation",), False, ("command",)),
    Form("sensor_lag", "first_order", _lag(0.0), ("sensor_lag",), similar=("command_delay",)),
    Form("sensor_lag", "dead_time", _lag(1.0), ("sensor_lag",), similar=("command_delay",)),
    Form("sensor_lag", "second_order", _lag(2.0), ("sensor_lag",), False, ("velocity",), ("command_delay",)),
    Form("sensor_gain", "steady", _plain(scale_error=0.06), (), False, similar=("sensor_gain",), visible=False),
    Form("sensor_gain", "drifting", _plain(scale_drift=8e-3), (), False, ("time",), ("sensor_gain",)),
    Form("sensor_drift", "linear", _plain(drift=1e-4), (), False, similar=("sensor_drift",), visible=False),
    Form("sensor_drift", "settling", _plain(drift=2e-4, drift_time=6.0), (), False, ("time",), ("sensor_drift",), False),
    Form("backlash", "play", _play(0.0), ("backlash",)),
    Form("backlash", "wind_up", _play(1.0), ("backlash",), False, ("direction", "position")),
    Form("load_mass", "placed", _placed, (), False, ("time", "acceleration", "condition")),
    Form("load_mass", "swinging", _swinging, (), False, ("acceleration", "time", "position")),
    Form("presliding", "lugre", _presliding(2.0), ("presliding",)),
    Form("presliding", "maxwell", _presliding(3.0), ("presliding",), False, ("position", "direction")),
    Form("friction_drift", "settling", _warming(0.0), ("friction_drift",)),
    Form("friction_drift", "root_of_travel", _warming(1.0), ("friction_drift",), False, ("time",)),
    # outside the program's library
    Form("ripple", "plain", _ripple(0.4, False), (), False, ("position",)),
    Form("ripple", "with_speed", _ripple(0.25, True), (), False, ("position", "velocity")),
    Form("pitch_error", "sine", _pitch, (), False, ("position", "velocity")),
    Form("thermal_gain", "settling", _plain(gain_loss=0.15), (), False, ("time", "command")),
    Form("speed_gain", "linear", _speed_loss, (), False, ("velocity", "command")),
    Form("vibration", "sine", _vibration, (), False, ("time",)),
)  # fmt: skip
