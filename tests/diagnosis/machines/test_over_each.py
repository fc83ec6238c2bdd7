"""What acts from outside otherwise in each condition is outside the library, with a course of its own for each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from asked import analysed, asked
from flywheel import GAIN, INERTIA, PERIOD, PLANT, VISCOUS

from hjcamp.commands.any_plant.next_commands import next_commands
from hjcamp.commands.any_plant.verdict_words import Words
from hjcamp.commands.shared.effect_from import begun_from
from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.candidates.nonparametric_terms import courses_of_each
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.results.answer import answer
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.records.log import TestLog

COUNT, NOISE = 1600, 0.02
# bends of a course by the time of the test, N m, in two conditions
TIMES = np.array([0.0, 3.0, 5.5, 9.0, 12.0, 16.0])
WINDS = {"calm": np.array([0.0, 6.0, 4.0, -5.0, -6.0, 2.0]) * 1e-3, "storm": np.array([5.0, -2.0, -6.0, 3.0, 7.0, -1.0]) * 1e-3}


def motor(winds: dict[str, np.ndarray], repetitions: int = 1) -> Measured:
    """Return tests of the flywheel, solved exactly from sample to sample, on which a wind turns."""
    Path("plants").mkdir()
    Path("plants/motor.py").write_text(PLANT, encoding="utf-8")
    kept, time, logs = np.exp(-VISCOUS / INERTIA * PERIOD), PERIOD * np.arange(COUNT), []
    for place, (name, bends) in enumerate(winds.items()):
        volts = np.repeat(np.random.default_rng(40 + place).uniform(-3.0, 3.0, COUNT // 40), 40)
        moment, speed = GAIN * volts + np.interp(time, TIMES, bends), np.zeros(COUNT)
        for k in range(COUNT - 1):
            speed[k + 1] = kept * speed[k] + (1.0 - kept) / VISCOUS * moment[k]
        for repetition in range(repetitions):
            shown = speed + NOISE * np.random.default_rng([place, repetition]).standard_normal(COUNT)
            columns = {"time_s": time, "voltage_v": volts, "speed_rad_per_s": shown}
            logs.append(TestLog(columns, {"plant": "motor", "period_s": str(PERIOD), "condition": name}))
    return measured_tests(logs)


def looked_at(measured: Measured) -> tuple[Analysis, Verdict]:
    return asked(measured, ["constant_force"])


@pytest.mark.study
@pytest.mark.xfail(strict=True, reason="its linear responses score below nothing on blocks left out, so that it is not fitted")
@pytest.mark.parametrize("repetitions", [1, 2])
def test_a_wind_that_differs_from_test_to_test_is_told_with_both_courses(
    repetitions: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    analysis, verdict = looked_at(motor(WINDS, repetitions))
    assert (verdict.word, verdict.effects) == ("outside_library", ())
    content = answer(analysis, verdict, 0.0)
    row = content["unknowns"][0]
    assert (row["driver"], row["quantity"], content["drivers"][0]) == ("time", "force", "time")
    assert row["left"] < 0.5 and row["apart_s"] > TIMES[-1]
    x, y = (np.array(row["curve"][axis]) for axis in ("x", "y"))
    for number, bends in enumerate(WINDS.values()):
        own = (x >= number * row["apart_s"]) & (x <= number * row["apart_s"] + TIMES[-1])
        true = np.interp(x[own] - number * row["apart_s"], TIMES, bends)
        # pieces of a third of a test are not quite the bends
        assert np.sqrt(np.mean((y[own] - true) ** 2)) < 0.3 * np.sqrt(np.mean(true**2))
    said = " ".join(Words(analysis, verdict, content).sentences())
    assert "that changes otherwise with time in each condition" in said and "can be measured and given" in said
    assert "Tests that would decide: the same tests once more, with what may act from outside recorded." in said
    assert ("an unmodelled memory" in said) == (repetitions == 1)
    with pytest.raises(UsageError, match=r"otherwise in each condition.*Input of the plant's file"):
        begun_from(content, Path("answer.json"))
    assert "--from" not in " ".join(next_commands(Words(analysis, verdict, content), "logs", "published"))


def test_the_same_wind_in_all_tests_has_one_course(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    analysis, verdict = looked_at(motor(dict.fromkeys(WINDS, WINDS["storm"])))
    row = answer(analysis, verdict, 0.0)["unknowns"][0]
    assert (verdict.word, row["driver"], row["apart_s"]) == ("outside_library", "time", 0.0)


def test_without_a_wind_nothing_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    _, verdict = looked_at(motor(dict.fromkeys(WINDS, np.zeros(len(TIMES)))))
    assert verdict.word == "nothing_missing"


def test_conditions_stand_in_a_row_on_the_axis_of_a_course(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    plant = motor(WINDS, 2).plant
    assert plant is find_plant("motor")
    found = courses_of_each(plant, 3, 5, 8.0, {"time": (0.0, 8.0), "load": (-1.0, 1.0)})
    assert list(found) == ["unknown_force_over_time_of_each"]
    one = found["unknown_force_over_time_of_each"]
    # five knots, 2 s from each other, in each of three conditions, and so far between them
    assert len(one.amplitudes) == 15 and (one.low, one.high, one.apart) == (0.0, 28.0, 10.0)


def test_tests_of_a_condition_have_its_number(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    layout = analysed(motor(WINDS, 2), ["constant_force"]).windows.layout
    plain = layout.groups
    assert len(plain) == 1 and plain[0][1].all()
    groups = layout.groups_by(["law.condition_number"])
    assert [given for given, _ in groups] == [{"law.condition_number": 0.0}, {"law.condition_number": 1.0}]
    for number, (_, windows) in enumerate(groups):
        assert {layout.measured.tests[test].condition for test in layout.of_test[windows]} == {list(WINDS)[number]}
