"""The tests of a plan as signals: played by another simulator, imported with the map as it was written, compared."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

from hjcamp import cli
from hjcamp.commands.campaigns.plan import compose_plan
from hjcamp.model.declare.plant import Plant

PROBE = """name: probe
description: Steps and a sine
fixed: {plant: carriage, controller: given}
vary:
  test:
    steps:
      trajectory: segments
      trajectory.segments: [{to_v: 4, in: 0.1, law: linear}, {rest: 0.4}, {to_v: -4, in: 0.2, law: linear}, {rest: 0.3}]
    sine: {trajectory: sine, trajectory.amplitude_v: 5, trajectory.frequency_hz: 1.0, trajectory.duration: 1.0}
repetitions: 2
"""


def played(signal: Path, into: Path) -> None:
    """Play a signal into a carriage of SciPy's: friction that is smooth about rest, no hjcamp in it."""
    with signal.open() as stream:
        rows = list(csv.DictReader(stream))
    time, volts = (np.array([float(row[name]) for row in rows]) for name in ("time_s", "voltage_v"))

    def rates(t: float, state: np.ndarray) -> list[float]:
        force = 35.0 * np.interp(t, time, volts) - 200.0 * state[1] - 20.0 * np.tanh(state[1] / 1e-4)
        return [state[1], force / 95.0]

    found = solve_ivp(rates, (time[0], time[-1]), [0.0, 0.0], "LSODA", t_eval=time, rtol=1e-8, atol=1e-10)
    with (into / signal.name).open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["time_s", "voltage_v", "position_m"])
        writer.writerows(zip(time, volts, np.round(found.y[0], 7), strict=True))


@pytest.fixture
def probe(carriage: type[Plant]) -> Path:
    """The carriage's folder with a campaign of two conditions."""
    Path("campaigns").mkdir()
    Path("campaigns/probe.yaml").write_text(PROBE, encoding="utf-8")
    return Path()


def test_the_signals_are_those_that_the_plan_would_give(probe: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["plan", "campaign=probe", "--signals", "out", "--json", "plan.json"]) == 0, capsys.readouterr().err
    files = json.loads(Path("plan.json").read_text())["signals"]
    assert len(files) == 5 and all(Path(one).is_file() for one in files)
    steps = np.genfromtxt("out/steps_rep_01.csv", delimiter=",", names=True)
    assert steps.dtype.names == ("time_s", "voltage_v")
    assert np.allclose(np.diff(steps["time_s"]), 0.001) and steps["voltage_v"].max() == 4.0 and steps["voltage_v"].min() == -4.0
    assert np.interp(0.05, steps["time_s"], steps["voltage_v"]) == pytest.approx(2.0, rel=0.02)
    duration = next(one.duration for one in compose_plan(["campaign=probe"]).conditions if one.name == "steps")
    assert len(steps) == round(duration / 0.001)
    rules = yaml.safe_load(Path("out/map.yaml").read_text(encoding="utf-8"))
    assert rules["files"]["sine_rep_02.csv"] == {"condition": "sine", "repetition": 2}
    assert rules["fields"]["position_m"] == {"column": "position_m", "unit": "m"}
    # what is there stays
    assert cli.run(["plan", "campaign=probe", "--signals", "out"]) == 2
    assert "is there already" in capsys.readouterr().err


@pytest.mark.study
def test_another_simulator_plays_them_and_its_logs_come_back_by_the_map(
    probe: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["plan", "campaign=probe", "--signals", "out"]) == 0
    Path("recorded").mkdir()
    for signal in sorted(Path("out").glob("*.csv")):
        played(signal, Path("recorded"))
    files = [str(one) for one in sorted(Path("recorded").glob("*.csv"))]
    assert cli.run(["import", *files, "--map", "out/map.yaml", "--into", "logs"]) == 0, capsys.readouterr().err
    assert cli.run(["compare", "logs", "--json", "answer.json"]) == 0, capsys.readouterr().err
    answer = json.loads(Path("answer.json").read_text())
    assert answer["plant"] == "carriage"


def test_a_plant_whose_loop_makes_its_commands_has_no_signals(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.run(["plan", "campaign=controllers", "--signals", "out"]) == 2
    assert "follows from its own loop" in capsys.readouterr().err and not Path("out").exists()
    assert cli.run(["plan", "-m", "campaign=controllers", "--signals", "out"]) == 2
    assert "--signals" in capsys.readouterr().err


def test_a_controlled_plant_gets_what_is_to_be_followed(probe: Path, capsys: pytest.CaptureFixture[str]) -> None:
    call = [
        "plan",
        "plant=carriage",
        "controller=plain_pid",
        "trajectory=segments",
        "trajectory.segments=[{to_m: 0.1, in: 0.5}]",
    ]
    assert cli.run([*call, "repetitions=1", "--signals", "out"]) == 0, capsys.readouterr().err
    [path] = Path("out").glob("*.csv")
    found = np.genfromtxt(path, delimiter=",", names=True)
    assert found.dtype.names == ("time_s", "reference_position_m") and found["reference_position_m"][-1] == pytest.approx(0.1)
