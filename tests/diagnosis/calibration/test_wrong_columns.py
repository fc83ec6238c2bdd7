"""Columns in a wrong unit or with a wrong sign: a model that runs away, and parameters that their bounds hold, are said."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import hjcamp
from hjcamp import cli
from hjcamp.diagnosis.calibration import active_bounds as held
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

PLANT = '''"""An arm that one propeller lifts."""

from numpy import sin

from hjcamp.plant import Input, Measured, Parameter, Plant, State, actuator, body, contact, outside, sensor


class Arm(Plant):
    """A propeller lifts an arm against its weight."""

    angle = State("rad")
    velocity = State("rad/s")
    throttle = Input("1")
    inertia = Parameter("kg*m^2", 0.02)
    gain = Parameter("N*m", 0.4, (0.02, 8.0), base=True)
    weight = Parameter("N*m", 0.2, (0.01, 4.0), base=True)
    viscous = Parameter("N*m*s/rad", 0.02, (0.0, 1.0), base=True)
    period = 0.04
    angle_rad = Measured("encoder", of="angle")

    @staticmethod
    def equations(state, parameter, drive, rate):
        torque = actuator(parameter.gain * drive.throttle)
        load = outside("N*m")
        friction = contact(state.velocity, viscous=parameter.viscous, travel=state.angle)
        rate.angle = state.velocity
        push = torque + load - parameter.weight * sin(state.angle) - friction
        rate.velocity = body(push, mass=parameter.inertia, load=load, position=state.angle)
        encoder = sensor(state.angle)
'''


@pytest.fixture
def columns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, np.ndarray]:
    """An arm that a throttle lifts in steps, by short steps of Euler's; the plant's file stands beside."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "arm.py").write_text(PLANT, encoding="utf-8")
    generator, count = np.random.default_rng(8), 240
    throttle, angle, state = np.repeat(generator.uniform(0.2, 0.5, count // 12), 12), np.zeros(count), np.zeros(2)
    for k in range(count - 1):
        for _ in range(80):
            pull = 0.4 * throttle[k] - 0.2 * np.sin(state[0]) - 0.02 * state[1]
            state = state + 0.0005 * np.array([state[1], pull / 0.02])
        angle[k + 1] = state[0]
    angle += 1e-3 * generator.standard_normal(count)
    return {"time_s": 0.04 * np.arange(count), "throttle_ratio": throttle, "angle_rad": angle}


def log_of(columns: dict[str, np.ndarray]) -> TestLog:
    return TestLog(columns, {"plant": "arm", "period_s": "0.04", "condition": "steps"})


def test_percent_that_pass_for_a_ratio(
    columns: dict[str, np.ndarray], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_log(tmp_path / "a.mcap", log_of({**columns, "throttle_ratio": 100.0 * columns["throttle_ratio"]}))
    assert cli.run(["compare", "a.mcap", "--json", "answer.json"]) == 0
    told = capsys.readouterr().out
    assert "published" in told and "diverges" in told and "nan" not in told
    answer = json.loads((tmp_path / "answer.json").read_text())
    assert answer["models"][0]["score"] is None and answer["models"][0]["error"]["angle_rad"]["rms"] is None
    assert answer["calibrated"]["score"] > 0.0
    assert "diverges" in (tmp_path / "compare" / "error_angle_rad.svg").read_text()
    found = hjcamp.compare("a.mcap")
    assert found.title == "error over noise floor: published diverges"
    assert found.frame["rms"].to_list() == [None]


def test_a_reversed_sign_is_told_from_the_parameters_that_stand_at_their_bounds(
    columns: dict[str, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    right = calibrated(measured_tests([log_of(columns)]), {}, unknowns=False)
    assert right.held == ()
    wrong = calibrated(measured_tests([log_of({**columns, "angle_rad": -columns["angle_rad"]})]), {}, unknowns=False)
    assert "gain" in wrong.held
    # an interval that reaches from the bound to what is declared is no reason to trust it
    wide = [replace(one, low=0.5 * one.value, high=1e3, told=True) for one in intervals(wrong.base.fitted, wrong.search.blocks)]
    monkeypatch.setattr(held, "intervals", lambda *given: wide)
    assert "gain" in held.held_away(wrong.search, wrong.base)
