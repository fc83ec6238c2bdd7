"""The pump joint in the common dialect: the rates of its own equations, its logs, and a diagnosis by the common method."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from hjcamp import cli
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.errors import UsageError
from hjcamp.model.checks.plant_checks import CHECKS, check_pushes, evaluate
from hjcamp.model.language.vocabulary import read_vocabulary
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.common import CommonJoint
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

SHARED = ("pressure1", "pressure2", "slider_position", "slider_velocity")
READ = {"arm_reading": "encoder", "pressure1_reading": "gauge1", "pressure2_reading": "gauge2"}


def place(seed: int, side: float) -> dict[str, float]:
    """Return states, inputs and parameters of both plants, at random; a pressure may be where water parts."""
    draw = np.random.default_rng([seed, int(side) + 1])
    found = {f"s_{name}": state.typical * draw.normal() for name, state in PumpJoint.states.items()}
    found |= {f"s_pressure{k}": draw.choice((draw.uniform(0.0, 0.7e6), draw.uniform(-0.3e6, -0.05e6))) for k in (1, 2)}
    found["s_slider_velocity"] = side * abs(found["s_slider_velocity"])
    for name, item in PumpJoint.parameters.items():
        found[f"p_{name}"] = item.default * draw.uniform(0.5, 2.0) if math.isfinite(item.default) else item.default
    found |= {"p_stiffness_asymmetry": draw.uniform(-0.3, 0.3), "p_arm_share": 0.3}
    limit = found["p_pump_speed_limit"]
    found["s_pump_velocity"] = draw.uniform(-limit, limit)
    found |= {"u_command": draw.normal(), "u_dither": draw.normal(), "u_preload_flow": 0.0, "u_time": draw.uniform(0.0, 9.0)}
    found |= {"u_friction_scatter": draw.uniform(0.9, 1.1), "u_direction": side}
    found |= {"u_pump": found["s_pump_position"] / found["p_pump_lead"]}
    found |= {"u_pump_speed": found["s_pump_velocity"] / found["p_pump_lead"]}
    return found


def test_it_is_a_sound_plant() -> None:
    for check in CHECKS.values():
        check(CommonJoint)
    check_pushes(CommonJoint)


@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
def test_its_rates_and_readings_are_those_of_the_joint(side: float) -> None:
    own, common = (read_vocabulary(plant).statements for plant in (PumpJoint, CommonJoint))
    for seed in range(100):
        here = place(seed, side)
        first, second = evaluate(PumpJoint, own, dict(here)), evaluate(CommonJoint, common, dict(here))
        for name in SHARED:
            # a rate is a difference of what may be far larger than itself
            size = first["p_line_stiffness"] * first["p_pump_area"] * 0.06 if name.startswith("pressure") else 1.0
            assert second[f"d_{name}"] == pytest.approx(first[f"d_{name}"], rel=1e-12, abs=1e-13 * size), (seed, name)
        for reading, sensor in READ.items():
            assert second[sensor] == pytest.approx(first[reading], rel=1e-14)
        for one, other in (("push", "friction_push"), ("friction_static", "friction_static"), ("friction", "friction")):
            assert second[other] == pytest.approx(first[one], rel=1e-12, abs=1e-11), (seed, one)


def log(**metadata: str) -> TestLog:
    """Return a log of the joint whose pump turns at 2 rev/s, at 1 kHz."""
    time = np.arange(100) * 1e-3
    columns = {"time_s": time, "pump_deg": 720.0 * time, "arm_deg": 10.0 * time}
    return TestLog(columns | {f"pressure{k}_mpa": np.full(100, 0.1 * k) for k in (1, 2)}, metadata)


def test_logs_of_the_joint_are_read_as_its_own_with_the_rate_of_the_pump() -> None:
    found = measured_tests([log()], plant=CommonJoint)
    test, names = found.tests[0], CommonJoint.sampled_inputs()
    assert [one.field for one in found.sensors] == ["arm_deg", "pressure1_mpa", "pressure2_mpa"]
    assert test.readings[-1] == pytest.approx([math.radians(10.0 * test.log.columns["time_s"][-1]), 0.1e6, 0.2e6])
    assert test.inputs[:-1, names.index("pump_speed")] == pytest.approx(4.0 * math.pi)
    assert not test.inputs[:, names.index("dither")].any()
    with pytest.raises(UsageError, match="field 'pump_deg' is missing, the input 'pump'"):
        measured_tests([TestLog({name: x for name, x in log().columns.items() if name != "pump_deg"})], plant=CommonJoint)


def test_the_hardware_of_a_log_is_known_but_for_what_is_calibrated() -> None:
    plain, other = (dict(measured_tests([one], plant=CommonJoint).tests[0].given) for one in (
        log(), log(pump="pump1", amplifier="low_gain", tubing="hdpe_300mm", payload="brass_8p5g")
    ))  # fmt: skip
    published = {name: item.default for name, item in CommonJoint.parameters.items()}
    assert plain == pytest.approx({name: published[name] for name in plain}) and not set(plain) & set(
        CommonJoint.base_parameters
    )
    assert other["pump_area"] == pytest.approx(math.pi / 4 * 4.0e-3**2)
    # 8.5 g at 20 mm on a pulley of 3.41 mm: 292 g at the sliders (5.5.1)
    assert other["moving_mass"] - plain["moving_mass"] == pytest.approx(8.5e-3 * (20.0 / 3.41) ** 2)


def test_an_unknown_method_is_refused_before_anything_is_read(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["diagnose", "nowhere", "--method", "comon"]) == 2
    assert "did you mean 'common'" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--alpha", "--delta"])
def test_numbers_that_would_decide_nothing_are_refused(
    option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_log(tmp_path / "logs" / "one.mcap", log())
    assert cli.run(["diagnose", "logs", option, "0.02"]) == 2
    assert f"{option} 0.02: plant pump_joint is judged at levels of its own; with --method common" in capsys.readouterr().err
    assert cli.run(["diagnose", "--tables", "table.csv", option, "0.02"]) == 2
    assert f"{option} 0.02: tables are judged from the published model, at levels of their own" in capsys.readouterr().err
