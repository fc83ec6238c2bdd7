"""A base parameter that differs between conditions is said, with its values; a base that does not is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from asked import asked
from flywheel import GAIN, INERTIA, PERIOD, PLANT, VISCOUS

from hjcamp.commands.any_plant.next_commands import next_commands
from hjcamp.commands.any_plant.remarks.outside_words import by_condition_words
from hjcamp.commands.any_plant.verdict_words import Words
from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.results.answer import answer
from hjcamp.records.log import TestLog

NOISE = 0.02


def motor(loaded: float, repetitions: int = 2) -> Measured:
    """Return repetitions of each of three conditions, solved exactly; with so much more inertia in the last one."""
    Path("plants").mkdir()
    Path("plants/motor.py").write_text(PLANT, encoding="utf-8")
    logs, count = [], 600
    for place, name in enumerate(("slow", "fast", "loaded")):
        course = np.random.default_rng(20 + place)
        voltage = np.repeat(course.uniform(-3.0, 3.0, count // (40 - 10 * place)), 40 - 10 * place)
        inertia = INERTIA * (loaded if name == "loaded" else 1.0)
        kept = np.exp(-VISCOUS / inertia * PERIOD)
        speed = np.empty(count)
        now = 0.0
        for k in range(count):
            speed[k] = now
            now = kept * now + (1.0 - kept) * GAIN / VISCOUS * voltage[k]
        for repetition in range(1, repetitions + 1):
            noise = NOISE * np.random.default_rng([place, repetition]).standard_normal(count)
            columns = {"time_s": PERIOD * np.arange(count), "voltage_v": voltage, "speed_rad_per_s": speed + noise}
            logs.append(TestLog(columns, {"plant": "motor", "period_s": str(PERIOD), "condition": name}))
    return measured_tests(logs)


def looked_at(measured: Measured) -> tuple[Analysis, Verdict]:
    return asked(measured, ["constant_force"])


def test_an_inertia_that_differs_in_one_condition_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    analysis, verdict = looked_at(motor(1.6))
    assert verdict.word == "outside_library" and verdict.differs is not None
    found = verdict.differs.parameters["inertia"]
    assert next(iter(verdict.differs.parameters)) == "inertia"
    assert {name: one.value / INERTIA for name, one in found.items()} == {
        "slow": pytest.approx(1.0, rel=0.01),
        "fast": pytest.approx(1.0, rel=0.01),
        "loaded": pytest.approx(1.6, rel=0.01),
    }
    row = answer(analysis, verdict, 0.0)["by_condition"]
    assert row["left"] == pytest.approx(1.0, abs=0.1)
    assert row["parameters"]["inertia"]["conditions"]["loaded"]["value"] == pytest.approx(1.6 * INERTIA, rel=0.01)
    [said, how] = by_condition_words(row, answer(analysis, verdict, 0.0)["error"]["baseline"])
    assert "inertia is" in said and "in loaded" in said and "given=NAME" in how


def test_a_base_that_is_the_same_everywhere_is_not_said_to_differ(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    analysis, verdict = looked_at(motor(1.0))
    assert verdict.word == "nothing_missing" and verdict.differs is None
    assert answer(analysis, verdict, 0.0)["by_condition"] == {}


def test_another_specimen_is_told_without_repetitions_and_calibrated_by_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    analysis, verdict = looked_at(motor(1.6, repetitions=1))
    words = Words(analysis, verdict, answer(analysis, verdict, 0.0))
    assert words.title == "OUTSIDE THE LIBRARY  parameters differ by condition" and not verdict.lacking
    assert verdict.differs is not None and next(iter(verdict.differs.parameters)) == "inertia"
    assert next_commands(words, "logs", "published")[0].startswith("hjcamp calibrate LOGS_OF_ONE --as NAME")
    [said, how] = by_condition_words(words.content["by_condition"], words.content["error"]["baseline"])
    assert said in words.sentences() and "Logs of several specimens are diagnosed one specimen at a time." in how


def test_values_that_read_alike_stand_together() -> None:
    rows = {at: {"value": value, "ci95": [value, value]} for at, value in (("a", 2.5), ("b", 2.5001), ("c", 3.4))}
    row = {"left": 1.0, "parameters": {"moving_mass": {"unit": "kg", "conditions": rows}}}
    assert by_condition_words(row, 28.0)[0] == (
        "No one set of parameters fits all conditions. Estimated for each alone, they leave 1 times the noise floor instead of 28: "
        "moving mass is 2.5 kg in a and b, 3.4 kg in c."
    )
