"""The truth servo and the two joints with a rope, against answers by hand, each hidden effect, files and draws."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from truth.axis.plant import Axis
from truth.servo.case import build_servo_case, simulate_servo, write_pendulum_case, write_servo_case
from truth.servo.hidden import ROPE_FORMS, SERVO_FORMS
from truth.servo.plant import PERIOD, Swing, run

# nothing of the program stands on it: it makes the data of the benchmarks
pytestmark = pytest.mark.study

FREE = Axis(
    mass=0.02,
    gain=1.0,
    coulomb_positive=1e-9,
    coulomb_negative=1e-9,
    viscous_positive=0.0,
    viscous_negative=0.0,
    current_lag=1e-6,
    count=1e-9,
)
SAME = {"viscous_positive": 0.05, "viscous_negative": 0.05}


def quiet(motor: Axis, swing: Swing, torque: np.ndarray, arm: Axis = FREE) -> np.ndarray:
    """Return the rows of a test without chance."""
    return run(motor, arm, swing, torque, np.zeros((2, 201)), np.zeros((2, torque.size)), 0.5)


def test_a_small_swing_has_the_period_of_a_pendulum_and_keeps_its_energy() -> None:
    torque = np.where(np.arange(4000) < 5, 0.2, 0.0)
    rows = quiet(FREE, Swing(weight=1.0), torque)
    angle, speed = rows[10:, 2], rows[10:, 4]
    energy = 0.5 * 0.02 * speed**2 + 1.0 - np.cos(angle)
    assert np.ptp(energy) < 2e-2 * energy.mean()
    crossings = np.flatnonzero((angle[1:] > 0) & (angle[:-1] <= 0))
    period = np.diff(crossings).mean() * PERIOD
    assert period == pytest.approx(2 * math.pi * math.sqrt(0.02) * (1 + angle.max() ** 2 / 16), rel=2e-3)


def test_a_steady_torque_holds_the_weight_and_friction_holds_it_too() -> None:
    damped = FREE._replace(**SAME)
    rows = quiet(damped, Swing(weight=2.0), np.full(4000, 1.0))
    assert math.sin(rows[-1, 2]) == pytest.approx(0.5, rel=1e-3)
    dry = damped._replace(coulomb_positive=0.3, coulomb_negative=0.3)
    assert np.all(quiet(dry, Swing(weight=2.0), np.full(500, 0.29))[:, 2] == 0.0)
    assert quiet(dry, Swing(weight=2.0), np.full(500, 0.33))[-1, 2] > 0.0


def test_the_rope_stretches_by_what_it_carries_and_both_contacts_hold() -> None:
    damped = FREE._replace(**SAME)
    swing = Swing(weight=1.0, rope=25.0, rope_damping=0.05)
    rows = quiet(damped, swing, np.full(6000, 0.5), damped)
    assert math.sin(rows[-1, 3]) == pytest.approx(0.5, rel=1e-3)
    assert rows[-1, 2] - rows[-1, 3] == pytest.approx(0.5 / 25.0, rel=1e-2)
    stuck = damped._replace(coulomb_positive=0.4, coulomb_negative=0.4)
    rising = 0.3 * np.minimum(np.arange(3000) / 2000, 1.0)
    rows = quiet(damped, swing, rising, stuck)
    assert np.all(rows[:, 3] == 0.0)
    assert rows[-1, 2] == pytest.approx(0.3 / 25.0, rel=1e-2)
    loose = quiet(damped, swing._replace(slack=0.02), rising, stuck)
    assert loose[-1, 2] == pytest.approx(0.02 + 0.3 / 25.0, rel=1e-2)


@pytest.mark.parametrize(
    ("roped", "form"),
    [(roped, form) for roped, forms in ((False, SERVO_FORMS), (True, ROPE_FORMS)) for form in forms],
    ids=lambda value: f"{value.effect}-{value.name}" if hasattr(value, "effect") else "",
)
def test_what_hides_changes_the_log(roped: bool, form) -> None:
    ratios = []
    contact = None if form.effect.startswith("presliding") else "sharp"
    for seed in (1, 2):
        case = build_servo_case(form.effect, form.name, seed, False, 2.0, contact, roped)
        rows, plain, again = (
            np.concatenate([simulate_servo(servo, seed, log, k)[2][:, : 1 + roped] for log in ("slow_sine", "steps", "chirp")])
            for servo, k in ((case.servo, 0), (case.plain, 0), (case.plain, 1))
        )
        ratios.append((np.mean((rows - plain) ** 2) / np.mean((again - plain) ** 2)) ** 0.5)
    assert np.isfinite(ratios).all()
    assert max(ratios) > 1.0
    assert np.abs(rows).max() < math.pi


def test_every_effect_of_the_library_has_a_form_that_it_does_not_know() -> None:
    for forms in (SERVO_FORMS, ROPE_FORMS):
        assert {form.effect for form in forms} == {form.effect for form in forms if not form.ours or not form.names}


@pytest.mark.parametrize("roped", [False, True])
def test_a_case_on_disk(tmp_path: Path, roped: bool) -> None:
    write, effect = (write_pendulum_case, "stribeck_arm") if roped else (write_servo_case, "stribeck")
    path = write(tmp_path / "case", effect, "exponential", 5, False, contact="maxwell")
    answer = json.loads(path.read_text())
    assert answer["effects"] == ["stribeck_excess_at_arm_rub" if roped else "stribeck_excess"]
    place = "arm" if roped else "motor"
    assert set(answer["changes"]) == {f"{place}.excess", f"{place}.fall_speed"}
    assert len(list((path.parent / "measured").iterdir())) == 18
    table = np.loadtxt(path.parent / "measured" / "steps_1.csv", delimiter=",", skiprows=1)
    assert table.shape == (2000, 4 if roped else 3)
    (source,) = (path.parent / "plants").glob("*.py")
    compile(source.read_text(), source.name, "exec")
    again = write(tmp_path / "again", effect, "exponential", 5, False, contact="maxwell")
    assert (again.parent / "measured" / "steps_1.csv").read_bytes() == (path.parent / "measured" / "steps_1.csv").read_bytes()
