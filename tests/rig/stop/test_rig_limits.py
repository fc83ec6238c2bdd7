"""Each limit of a rig, alone, and what a configuration must say."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig.limits import LimitCheck, Limits, read_limits
from hjcamp.plants.pump_joint.rig.silence import Coupling

DEGREE = pi / 180
VOLTS = np.array([2.0, 2.0])
LIMITS = Limits(-0.12, 0.65, 0.2, 6.0, 70.0, 1500.0, 250.0, 1.2, 170.0, 5000.0, 50.0, 2, 4, 100.0)

RANGE = ((0.9, 5.1), (0.9, 5.1))
COUPLING = Coupling(42.3, 1.23)


def row(phase: float = 3.0, reference: float = 0.0, command: float = 0.0) -> np.ndarray:
    return np.array([phase, reference * DEGREE, command * DEGREE, 0.0, 0.0, 0.0, 0.0])


def check(limits: Limits = LIMITS, **values: Any) -> str | None:
    given = {
        "missed": 0,
        "volts": VOLTS,
        "pressure1": 0.26e6,
        "pressure2": 0.26e6,
        "arm": 0.0,
        "motor": 0.0,
        "out": row(),
    }
    return LimitCheck(limits, 1e-3, RANGE, COUPLING).check(**{**given, **values})


def test_nothing_is_wrong() -> None:
    assert check() is None


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"pressure2": 0.66e6}, "pressure 0.660 MPa is above 0.65 MPa"),
        ({"pressure1": -0.13e6}, "below -0.12 MPa"),
        ({"pressure1": 0.05e6, "pressure2": 0.1e6}, "lose water"),
        ({"volts": np.array([2.0, 0.0])}, "pressure sensor 2 is lost"),
        ({"volts": np.array([5.2, 2.0])}, "pressure sensor 1 is lost"),
        ({"volts": np.array([np.nan, 2.0])}, "pressure sensor 1 is lost"),
        ({"arm": -171 * DEGREE}, "arm at -171.0 deg"),
        ({"motor": 6.1 * 2 * pi}, "pump at 6.10 mm"),
        ({"out": row(command=1501.0)}, "behind its command"),
        ({"out": row(reference=51.0)}, "tracking error 51.0 deg"),
        ({"out": row(phase=0.0), "arm": 60 * DEGREE}, "tracking error 60.0 deg"),
        ({"missed": 3}, "3 samples were missed at once"),
    ],
)
def test_limit(values: dict[str, Any], words: str) -> None:
    reason = check(**values)
    assert reason is not None
    assert words in reason


def test_lines_may_be_low_before_the_rest_and_in_the_release() -> None:
    low = {"pressure1": 0.06e6, "pressure2": 0.06e6}
    assert check(**low, out=row(phase=0.0)) is None
    assert check(**low, out=row(phase=4.0)) is None
    assert check(**low, out=row(phase=2.0)) is not None


def test_speeds_and_samples_in_all() -> None:
    def watch(**step: float) -> str | None:
        limits = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
        for k in range(40):
            arm, motor = k * step.get("arm", 0.0), k * step.get("motor", 0.0)
            out = row(reference=arm / DEGREE, command=motor / DEGREE)
            reason = limits.check(int(step.get("missed", 0)), VOLTS, 0.26e6, 0.26e6, arm, motor, out)
            if reason:
                return reason
        return None

    assert watch(arm=4 * DEGREE, motor=0.3) is None
    assert "arm speed 5100" in str(watch(arm=5.1 * DEGREE, motor=0.3)).replace(",", "")
    assert "pump speed 75.0" in str(watch(arm=0.05, motor=0.075 * 2 * pi))
    assert "5 samples were missed in all" in str(watch(arm=0.05, missed=1))


def test_silent_encoders() -> None:
    limits = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
    reasons = [limits.check(0, VOLTS, 0.26e6, 0.26e6, 0.0, 0.0, row(command=2.0 * k)) for k in range(130)]
    assert reasons[99] is None
    assert "pump encoder is silent for 100 ms" in str(reasons[100])
    limits = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
    jump = [limits.check(0, VOLTS, 0.26e6, 0.26e6, 0.0, 0.0, row(command=300.0 * (k > 0))) for k in range(30)]
    assert jump[19] is None
    assert "pump encoder is silent" in str(jump[20])
    limits = LimitCheck(replace(LIMITS, arm_silent_deg=float("inf")), 1e-3, RANGE, COUPLING)
    steps = [0.01 * 2 * pi * k for k in range(140)]
    reasons = [limits.check(0, VOLTS, 0.26e6, 0.26e6, 0.0, m, row(command=m / DEGREE)) for m in steps]
    assert reasons[119] is None
    assert "arm encoder is silent" in str(reasons[122])


def test_a_pump_encoder_that_stays_silent_over_a_small_motion() -> None:
    limits = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
    rest = [limits.check(0, VOLTS, 0.26e6, 0.26e6, 0.0, 0.0, row(command=40.0)) for _ in range(1000)]
    moved = [limits.check(0, VOLTS, 0.26e6, 0.26e6, 0.0, 0.0, row(command=100.0)) for _ in range(110)]
    assert rest == [None] * 1000  # a motor that stands may have stood for long
    assert moved[90] is None
    assert "its command has moved by 60 deg" in str(moved[105])


def test_a_step_after_a_long_rest_is_no_silence() -> None:
    limits = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
    commands = [0.0] * 500 + [360.0] * 30
    reasons = [limits.check(0, VOLTS, 0.26e6, 0.26e6, 0.0, 0.0, row(command=one)) for one in commands]
    assert reasons[:519] == [None] * 519
    assert "pump encoder is silent" in str(reasons[520])


@pytest.mark.parametrize(
    ("stored", "says"),
    [
        (1.0, None),  # friction holds the arm: the lines take what the pump moves
        (0.5, None),  # lines twice as soft as configured
        (0.0, "the arm turned 6 deg"),  # the arm turned and its encoder does not count
        (-1.0, "the arm turned 6 deg"),
    ],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_silent_arm_encoder_is_told_from_an_arm_that_stands(stored: float, says: str | None, side: float) -> None:
    limits = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
    for k in range(80):
        travel = side * 0.005 * k
        rise = stored * travel / COUPLING.mm_per_mpa * 1e6
        motor = travel * 2 * pi
        reason = limits.check(0, VOLTS, 0.26e6 + rise, 0.26e6 - rise, 0.0, motor, row(command=motor / DEGREE))
        if reason:
            break
    assert says in reason if says and reason else reason is says
    if says:
        assert k == 29  # 0.145 mm: 6 deg


def test_without_preload_the_arm_may_lag_further() -> None:
    limits = LimitCheck(LIMITS, 1e-3, RANGE, COUPLING)
    motors = [0.01 * 2 * pi * k for k in range(200)]
    out = [limits.check(0, VOLTS, 0.0, 0.0, 0.0, m, row(phase=4.0, command=m / DEGREE)) for m in motors]
    assert out[179] is None
    assert "silent while the pump moved by 1.8 mm" in str(out[182])


def test_a_missing_limit_is_no_permission(compose: Any) -> None:
    config = compose()
    given = config["rig"]["limits"]
    assert read_limits(config).arm_deg == 200.0
    assert read_limits(config).arm_silent_deg == 6.0
    assert read_limits(compose("++rig.limits.arm_silent_deg=null")).arm_silent_deg == float("inf")
    old = {name: value for name, value in given.items() if name != "arm_silent_deg"}
    assert read_limits({"rig": {"limits": old}}).arm_silent_deg == 6.0
    with pytest.raises(UsageError, match=r"rig\.limits\.arm_deg is missing"):
        read_limits({"rig": {"limits": {name: value for name, value in given.items() if name != "arm_deg"}}})
    for change, words in (
        ({"arm_degs": 1}, "did you mean 'arm_deg'"),
        ({"arm_deg": "far"}, r"arm_deg is 'far'; a number from 1 to 360"),
        ({"tracking_deg": "far"}, "a number from 0.1 to 720 or null"),
    ):
        with pytest.raises(UsageError, match=words):
            read_limits({"rig": {"limits": {**given, **change}}})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, None) for name in ("pressure_low_mpa", "pressure_high_mpa", "pump_travel_mm", "pump_speed_mm_per_s")),
        *((name, None) for name in ("arm_deg", "arm_speed_deg_per_s", "missed_at_once", "missed_in_all")),
        ("read_timeout_ms", None),
        ("read_timeout_ms", -1000),
        ("pressure_high_mpa", -5),
        ("pressure_high_mpa", 50),
        ("missed_at_once", 1e9),
        ("missed_at_once", 10**9),
        ("missed_in_all", 10**9),
        ("arm_deg", True),
    ],
)
def test_what_guards_people_or_glass_has_bounds(compose: Any, name: str, value: Any) -> None:
    config = compose()
    with pytest.raises(UsageError, match=rf"rig\.limits\.{name} is "):
        read_limits({"rig": {"limits": {**config["rig"]["limits"], name: value}}})


def test_null_is_no_limit() -> None:
    assert check(replace(LIMITS, arm_deg=float("inf"), arm_speed_deg_per_s=float("inf")), arm=3.0, out=row(4.0)) is None
