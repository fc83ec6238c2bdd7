"""Hidden cases on a servo with a swinging load, and on two joints with a rope: torque given, angles measured."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from truth.axis.hidden import Use
from truth.axis.plant import Axis
from truth.case_files import MeasuredLog, rough, write_case_files
from truth.contact import CONTACTS
from truth.hidden_form import Form, find_form, level_of
from truth.moves import fluctuation
from truth.servo.hidden import ROPE_FORMS, SERVO_FORMS, Servo
from truth.servo.plant import PERIOD, Swing, run
from truth.servo.sources import ROPE, SERVO

ONE_LOG_S, HELD_OUT_S, TEST_S = 24.0, 12.0, 4.0
CONDITIONS = ("steps", "slow_sine", "fast_sine", "chirp", "creep", "release")
SERVO_FIELDS = {"time_s": "t_s", "angle_deg": "phi_deg", "torque_nm": "tau_nm"}
ROPE_FIELDS = {"time_s": "t_s", "motor_deg": "phi_motor_deg", "torque_nm": "tau_nm", "arm_deg": "phi_arm_deg"}


@dataclass(frozen=True)
class ServoCase:
    """A servo, or two joints with a rope, with what hides in it."""

    servo: Servo
    plain: Servo
    form: Form[Servo]
    seed: int
    roped: bool


def draw_servo(seed: int, roped: bool, contact: str | None, one_log: bool) -> Servo:
    """Draw 0.2 - 1 kg at 10 - 25 cm, friction 3 - 8 % of the weight's torque, encoders of 2^12 to 2^16 counts."""
    if contact is not None and contact not in CONTACTS:
        raise ValueError(f"contact {contact!r}: known are {', '.join(CONTACTS)}")
    random = np.random.default_rng([seed, 501])
    mass, radius = float(random.uniform(0.2, 1.0)), float(random.uniform(0.1, 0.25))
    inertia = mass * radius**2 * float(random.uniform(1.1, 1.6))
    weight = mass * 9.81 * radius * float(random.uniform(0.7, 0.95))
    speed = 3.0
    drawn = int(random.integers(len(CONTACTS)))
    law = CONTACTS.index(contact) if contact else drawn
    joints = []
    for size in (1.0, 1.0) if not roped else (float(random.uniform(0.25, 0.5)), 1.0):
        coulomb = weight * float(random.uniform(0.03, 0.08)) * (0.7 if roped else 1.0)
        damping = 2 * float(random.uniform(0.04, 0.12)) * np.sqrt(weight * inertia) * (0.6 if roped else 1.0)
        grains = (1.0, float(random.uniform(2e-3, 5e-3)) * speed, 1e-4, 1e-4)
        joints.append(
            Axis(
                mass=inertia * size,
                gain=1.0,
                coulomb_positive=coulomb,
                coulomb_negative=coulomb,
                viscous_positive=float(damping),
                viscous_negative=float(damping),
                law=float(law),
                grain=grains[law],
                current_lag=float(random.uniform(2e-4, 8e-4)),
                count=2 * np.pi / 2 ** int(random.choice([12, 14, 16])),
            )
        )
    swing = Swing(weight=weight)
    if roped:
        stiffness = joints[0].mass * float(random.uniform(35, 60)) ** 2
        swing = swing._replace(rope=stiffness, rope_damping=0.1 * float(np.sqrt(stiffness * joints[0].mass)))
    use = Use(1.2, speed, 0.6 * weight / inertia, ONE_LOG_S if one_log else TEST_S)
    return Servo(joints[0], joints[1], swing, use)


def hide(servo: Servo, changes: Mapping[str, float]) -> Servo:
    """Return the servo with changes, each called `motor.<field>`, `arm.<field>` or `swing.<field>`."""
    for name, value in changes.items():
        part, _, field = name.partition(".")
        servo = servo._replace(**{part: getattr(servo, part)._replace(**{field: value})})
    return servo


def build_servo_case(
    effect: str = "nothing",
    form: str | None = None,
    seed: int = 0,
    one_log: bool = True,
    strength: str | float = "medium",
    contact: str | None = None,
    roped: bool = False,
) -> ServoCase:
    """Draw a machine and hide the effect in it; see `write_servo_case`. Raises ValueError for what is not known."""
    level = level_of(strength)
    chosen = find_form(ROPE_FORMS if roped else SERVO_FORMS, effect, form, seed)
    servo = draw_servo(seed, roped, contact, one_log)
    changes = chosen.build(servo, level, np.random.default_rng([seed, 509]))
    return ServoCase(hide(servo, changes), servo, chosen, seed, roped)


def torque_course(name: str, samples: int, random: np.random.Generator) -> np.ndarray:
    """Return a torque (share of the weight's, each 2 ms) of a condition, or of one after the other for a long log."""
    time = np.arange(samples) * PERIOD
    if name in ("train", "held_out"):
        parts: list[np.ndarray] = []
        while sum(part.size for part in parts) < samples:
            parts += [torque_course(str(kind), round(3.0 / PERIOD), random) for kind in random.permutation(CONDITIONS)]
        return np.concatenate(parts)[:samples]
    size = float(random.uniform(0.8, 1.1))
    if name == "steps":
        levels = np.repeat(random.uniform(-0.6, 0.6, samples // 350 + 1), 350)[:samples]
        return size * levels
    if name == "release":
        return (
            size * np.where(time % 2.0 < 1.2, np.minimum(time % 2.0 / 0.9, 1.0) * 0.7, 0.0) * np.where(time % 4.0 < 2.0, 1, -1)
        )
    if name == "creep":
        return size * 0.6 * (np.abs((time / 2.0 + 0.5) % 2 - 1) * 2 - 1)
    rate = {"slow_sine": 0.4, "fast_sine": 2.2}.get(name, 0.0)
    if rate:
        return size * (0.6 if rate < 1 else 0.7) * np.sin(2 * np.pi * rate * float(random.uniform(0.9, 1.1)) * time)
    return size * 0.4 * np.sin(2 * np.pi * (0.3 + 0.9 * time / (samples * PERIOD)) * time)


def simulate_servo(servo: Servo, seed: int, log: str, repetition: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time (n,), torque (n,) in N m and rows (n, 6) of `servo.run` in one log: "train", "held_out", a condition."""
    number = ("train", "held_out", *CONDITIONS).index(log)
    random = np.random.default_rng([seed, 505, number])
    samples = round({"train": ONE_LOG_S, "held_out": HELD_OUT_S}.get(log, TEST_S) / PERIOD)
    torque = np.round(servo.swing.weight * torque_course(log, samples, random), 6)
    chance = np.random.default_rng([seed, 507, number, repetition])
    drawn = [fluctuation(samples, chance) for _ in range(2)]
    profile, wander = np.array([one.profile for one in drawn]), np.array([one.wander for one in drawn])
    rows = run(servo.motor, servo.arm, servo.swing, torque, profile, wander, drawn[0].counted)
    return np.arange(samples) * PERIOD, torque, rows


def write_servo_case(
    folder: Path | str,
    effect: str = "nothing",
    form: str | None = None,
    seed: int = 0,
    one_log: bool = True,
    *,
    strength: str | float = "medium",
    contact: str | None = None,
    roped: bool = False,
) -> Path:
    """Write a hidden case on a servo with a swinging load and return the path of its sealed answer, `truth.json`.

    As `write_axis_case`, with the torque given and one sample each 2 ms: `measured/train.csv` (24 s), or six conditions
    of 4 s with three repetitions; `heldout/held_out.csv` (12 s). Each test starts at rest, hanging down.
    """
    case = build_servo_case(effect, form, seed, one_log, strength, contact, roped)
    plan = [("train", 0)] if one_log else [(name, k) for name in CONDITIONS for k in range(3)]
    fields = ROPE_FIELDS if roped else SERVO_FIELDS
    shown = 2 if roped else 1
    logs, seen = [], []
    for name, repetition in [*plan, ("held_out", 0)]:
        time, torque, rows = simulate_servo(case.servo, seed, name, repetition)
        degrees = np.degrees(rows[:, :2])
        columns = dict(zip(fields.values(), (time, degrees[:, 0], torque, degrees[:, 1]), strict=False))
        metadata = {"condition": name}
        if not one_log:
            metadata["repetition"] = str(repetition + 1)
        file = name if one_log or name == "held_out" else f"{name}_{repetition + 1}"
        logs.append(MeasuredLog(file, columns, metadata, name == "held_out"))
        if name != "held_out" and repetition == 0:
            plain, again = (simulate_servo(case.plain, seed, name, k)[2][:, :shown] for k in (0, 99))
            seen.append((np.mean((rows[:, :shown] - plain) ** 2), np.mean((again - plain) ** 2)))
    change, scatter = np.degrees(np.sqrt(np.mean(seen, axis=0)))
    answer = {
        "plant": "pendulum" if roped else "servo",
        **case.form.answer(),
        "strength": strength,
        "contact": CONTACTS[int(case.plain.motor.law)],
        "one_log": one_log,
        "seed": seed,
        "changes": _changes(case),
        "base": base_parameters(case),
        "seen": {"change_deg": float(change), "scatter_deg": float(scatter)},
    }
    return write_case_files(folder, str(answer["plant"]), plant_source(case), fields, logs, answer)


def write_pendulum_case(
    folder: Path | str,
    effect: str = "nothing",
    form: str | None = None,
    seed: int = 0,
    one_log: bool = True,
    *,
    strength: str | float = "medium",
    contact: str | None = None,
) -> Path:
    """Write a hidden case on two joints, each with friction, of which the first swings the second over a rope.

    Both angles are measured. Everything else as in `write_servo_case`; effects are called `<effect>_motor` or
    `<effect>_arm` by where they sit.
    """
    return write_servo_case(folder, effect, form, seed, one_log, strength=strength, contact=contact, roped=True)


def _changes(case: ServoCase) -> dict[str, float]:
    found = {}
    for part in ("motor", "arm", "swing"):
        plain = getattr(case.plain, part)._asdict()
        now = getattr(case.servo, part)._asdict()
        found |= {f"{part}.{name}": value for name, value in now.items() if value != plain[name]}
    return found


def base_parameters(case: ServoCase) -> dict[str, float]:
    """Return the true values of the parameters of the user's plant."""
    motor, arm, swing = case.plain.motor, case.plain.arm, case.plain.swing
    if not case.roped:
        names = (motor.mass, swing.weight, motor.coulomb_positive, motor.viscous_positive)
        return dict(zip(("inertia", "weight", "coulomb", "viscous"), names, strict=True))
    return {
        "motor_inertia": motor.mass,
        "arm_inertia": arm.mass,
        "weight": swing.weight,
        "rope": swing.rope,
        "rope_damping": swing.rope_damping,
        "motor_coulomb": motor.coulomb_positive,
        "arm_coulomb": arm.coulomb_positive,
        "motor_viscous": motor.viscous_positive,
        "arm_viscous": arm.viscous_positive,
    }


def plant_source(case: ServoCase) -> str:
    """Return the file that a user of this machine would write: guesses of one digit, wide bounds."""
    random = np.random.default_rng([case.seed, 511])
    arm, motor, swing = case.plain.arm, case.plain.motor, case.plain.swing
    guess: dict[str, Any] = {
        "inertia": rough(arm.mass, random),
        "weight": rough(swing.weight, random, 0.2),
        "coulomb": rough(arm.coulomb_positive, random),
        "viscous": rough(arm.viscous_positive, random),
        "motor_inertia": rough(motor.mass, random),
        "motor_coulomb": rough(motor.coulomb_positive, random),
        "rope": rough(max(swing.rope, 1.0), random),
        "damping": rough(max(swing.rope_damping, 1e-3), random),
    }
    names = (("inertia", "inertia"), ("coulomb", "coulomb"), ("motor", "motor_inertia"), ("rope", "rope"))
    guess |= {f"{name}_low": guess[of] / 20 for name, of in names}
    guess |= {f"{name}_high": guess[of] * 20 for name, of in (*names, ("viscous", "viscous"), ("damping", "damping"))}
    guess["weight_high"] = 10 * guess["weight"]
    if case.roped:
        return ROPE.format(**guess)
    played = case.form.effect == "backlash" or np.random.default_rng([case.seed, 513]).random() < 0.3
    sensor = "encoder = sensor(state.angle)"
    if played:
        sensor = "shaft = transmission(state.angle)\n        encoder = sensor(shaft)"
    return SERVO.format(more=", transmission" if played else "", sensor=sensor, **guess)
