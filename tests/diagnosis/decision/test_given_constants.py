"""A constant that the plant's file gives wrongly is told beside what is found instead; one that is right is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from answer_schemas import check_answer
from asked import asked
from flywheel import GAIN, INERTIA, NOISE, PERIOD, PLANT, VISCOUS

from hjcamp.commands.any_plant.remarks.outside_words import constant_words
from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.results.answer import answer
from hjcamp.records.log import TestLog

KNOWN = PLANT.replace('1.2e-3, (1e-6, 1e-1), "log-uniform", base=True)', "1.2e-3)")


def motor(pushed: float = 0.0) -> Measured:
    """Return two logs of a motor, solved exactly: with a force (N*m) that its file lacks, else one that gives 20 % too much inertia."""
    Path("plants").mkdir()
    Path("plants/motor.py").write_text(KNOWN if not pushed else KNOWN.replace("1.2e-3)", "1.0e-3)"), encoding="utf-8")
    logs, count, kept = [], 1200, np.exp(-VISCOUS / INERTIA * PERIOD)
    for place, name in enumerate("ab"):
        course = np.random.default_rng(40 + place)
        voltage, speed, now = np.repeat(course.uniform(-3.0, 3.0, count // 40), 40), np.empty(count), 0.0
        for k in range(count):
            speed[k] = now
            now = kept * now + (1.0 - kept) * (GAIN * voltage[k] + pushed) / VISCOUS
        columns = {
            "time_s": PERIOD * np.arange(count),
            "voltage_v": voltage,
            "speed_rad_per_s": speed + NOISE * course.standard_normal(count),
        }
        logs.append(TestLog(columns, {"plant": "motor", "period_s": str(PERIOD), "condition": name}))
    return measured_tests(logs)


def looked_at(measured: Measured) -> tuple[Analysis, Verdict]:
    return asked(measured, ["constant_force"])


def test_a_wrong_inertia_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    analysis, verdict = looked_at(motor())
    assert verdict.word == "outside_library" and not verdict.effects
    said = answer(analysis, verdict, 0.0)
    check_answer(said)
    rows = said["constants"]
    # with the other one fitted the gain does the same
    assert {name: one["value"] for name, one in rows.items()} == {
        "inertia": pytest.approx(INERTIA, rel=0.01),
        "gain": pytest.approx(1.2 * GAIN, rel=0.01),
    }
    # by the balances that are expected of the right one: by those of the base it was 0.15 % off, and its interval 0.04 % wide
    low, high = rows["inertia"]["ci95"]
    assert low < INERTIA < high and high - low < 1e-3 * INERTIA
    assert rows["inertia"]["left"] < 0.5 * said["error"]["baseline"]
    [first, _] = constant_words({"inertia": rows["inertia"], "gain": rows["gain"]}, said["error"]["baseline"])
    assert first.startswith("The plant's file gives inertia as 0.0012 kg*m**2. With 0.00") and "base=True at inertia" in first


def test_constants_that_are_right_are_not_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    analysis, verdict = looked_at(motor(pushed=0.01))
    assert verdict.effects == ("constant_force",)
    assert answer(analysis, verdict, 0.0)["constants"] == {}
