"""What can be hidden in the servo with a swinging load and in the two joints with a rope: those of the axis, and their own."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from truth.axis.hidden import FORMS as AXIS_FORMS
from truth.axis.hidden import Use
from truth.axis.plant import Axis
from truth.hidden_form import Changes, Form
from truth.servo.plant import Swing


class Servo(NamedTuple):
    """A motor joint, an arm (the same joint where there is no rope), what swings, and how it is used (rad)."""

    motor: Axis
    arm: Axis
    swing: Swing
    use: Use


Build = Callable[[Servo, float, np.random.Generator], Changes]
# Of the axis, what a joint has as well; how its loop or its mass would show does not carry over.
OF_JOINT = (
    "stribeck", "position_friction", "asymmetry", "constant_force", "spring", "quadratic_drag", "command_delay", "dead_band",
    "saturation", "sensor_lag", "backlash", "presliding", "friction_drift", "ripple", "thermal_gain", "speed_gain", "vibration",
)  # fmt: skip
# What can sit at either joint of the two; the rest is the drive's and the first encoder's.
OF_CONTACT = ("stribeck", "position_friction", "asymmetry", "presliding", "quadratic_drag", "friction_drift")
OF_BODY = ("constant_force", "spring")
# A joint without a loop shows these less than an axis that is made to follow.
LARGER = {"backlash": 8.0, "presliding": 4.0, "vibration": 3.0, "asymmetry": 1.5}
OF_DRIVE = ("command_delay", "dead_band", "saturation")


def _of_axis(form: Form, place: str) -> Form:
    """Return an axis' form for the joint `place` ("motor" or "arm"), its fields called `<place>.<field>`."""

    def build(servo: Servo, level: float, random: np.random.Generator) -> Changes:
        # a drive moves the arm as well, where that is another joint
        joint = servo.motor._replace(mass=servo.arm.mass) if form.effect in OF_DRIVE else getattr(servo, place)
        changes = form.build((joint, servo.use), LARGER.get(form.effect, 1.0) * level, random)
        return {f"{place}.{name}": value for name, value in changes.items()}

    return replace(form, build=build)


def _swing(**factors: float) -> Build:
    return lambda servo, level, random: {f"swing.{name}": factor * level for name, factor in factors.items()}


def _lean(servo: Servo, level: float, random: np.random.Generator) -> Changes:
    return {"swing.lean": 0.12 * level * float(random.choice([-1.0, 1.0]))}


def _leaning(servo: Servo, level: float, random: np.random.Generator) -> Changes:
    return {"swing.lean_rate": 0.25 * level / servo.use.duration * float(random.choice([-1.0, 1.0]))}


def _stop(form: float) -> Build:
    return lambda servo, level, random: {
        "swing.stop": 8 * level * servo.swing.weight,
        "swing.stop_angle": float(random.uniform(0.3, 0.4)),
        "swing.stop_form": form,
    }


def _eccentric(periods: float) -> Build:
    def build(servo: Servo, level: float, random: np.random.Generator) -> Changes:
        return {
            "motor.pitch_error": 0.05 * level,
            "motor.ripple_length": 2 * math.pi / periods,
            "motor.ripple_phase": float(random.uniform(-math.pi, math.pi)),
        }

    return build


SERVO_FORMS: tuple[Form, ...] = (
    *(_of_axis(form, "motor") for form in AXIS_FORMS if form.effect in OF_JOINT),
    Form("sensor_offset", "steady", _lean, ("sensor_offset",), similar=("pendulum_weight", "constant_force")),
    Form("sensor_offset", "leaning", _leaning, (), False, ("time",), ("sensor_drift",)),
    Form("eccentricity", "once", _eccentric(1.0), ("eccentricity",)),
    Form("eccentricity", "five_times", _eccentric(5.0), ("eccentricity",), False, ("angle", "position")),
    Form("stop", "hunt_crossley", _stop(0.0), ("hard_stop",), similar=("soft_stop",)),
    Form("stop", "rubber", _stop(1.0), ("hard_stop",), False, ("angle", "position"), ("soft_stop",)),
    Form("sliding_weight", "square", _swing(sliding=0.03), (), False, ("angle", "velocity")),
)


def _at(form: Form, place: str) -> Form:
    """Return the form as the plant of two joints calls it, where each joint has a contact, a body and an encoder."""
    port = f"{place}_rub" if form.effect in OF_CONTACT else f"{place}_speed" if form.effect in OF_BODY else f"{place}_encoder"
    contact, body = f"_at_{place}_rub", f"_at_{place}_speed"
    ends = {"coulomb_asymmetry": contact, "viscous_asymmetry": contact, "constant_force": body}
    if form.effect in OF_DRIVE:
        names = form.names
        similar = tuple(f"{name}_at_motor_encoder" for name in form.similar)
    else:
        names = tuple(f"{name}{ends.get(name, f'_at_{port}')}" for name in form.names)
        similar = tuple(name if name == "command_delay" else f"{name}{ends.get(name, f'_at_{port}')}" for name in form.similar)
    return replace(_of_axis(form, place), effect=f"{form.effect}_{place}", names=names, similar=similar)


ROPE_FORMS: tuple[Form, ...] = (
    *(_at(form, place) for place in ("motor", "arm") for form in AXIS_FORMS if form.effect in (*OF_CONTACT, *OF_BODY)),
    *(_at(form, "motor") for form in AXIS_FORMS if form.effect in (*OF_DRIVE, "sensor_lag", "thermal_gain", "ripple")),
    Form("rope", "hardening", _swing(hardening=600.0), (), False, ("stretch", "angle")),
    Form("rope", "slack", _swing(slack=0.01), (), False, ("stretch", "angle", "direction")),
)
