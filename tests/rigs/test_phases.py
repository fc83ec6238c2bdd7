"""Phases that a plant declares around the motion of its tests: on the simulator, on a rig, in logs, signals and budgets."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lab_of_rigs import AXIS, MOTION, RIG, Made

from hjcamp.backends import plant_simulation
from hjcamp.backends.plant_simulation import plant_in, prepare, simulator_of
from hjcamp.backends.rig.any_plant.backend import run_test
from hjcamp.backends.schedule import Schedule, schedule_of
from hjcamp.cli import run
from hjcamp.commands.hunting.budget import planned_seconds
from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.live.describe import phases_of
from hjcamp.model.language.field_table import fields_of

PHASES = """    phases_before = (Phase("preload", 0.05, {"voltage": 0.4}), Phase("hold", 0.02))
    phases_after = (Phase("release", 0.04, {"voltage": 0.1}),)
    period = 0.001"""
PRESS = AXIS.replace("Plant, State,", "Phase, Plant, State,").replace("    period = 0.001", PHASES).replace("Axis1", "Press")
ON_PRESS = ("plant=press", *MOTION[1:])


@pytest.fixture
def press(lab: Path) -> Path:
    """Return the plant with phases."""
    path = lab / "plants" / "press.py"
    path.write_text(PRESS)
    return path


def stretches(columns: dict[str, np.ndarray]) -> dict[float, tuple[int, float, float]]:
    """Return for each phase how many samples it has, and the first and the last voltage."""
    volts, phase = columns["voltage_v"], columns["phase"]
    return {one: (int((phase == one).sum()), *volts[phase == one][[0, -1]]) for one in np.unique(phase)}


def test_phases_are_made_as_declared_and_on_a_rig_as_on_the_simulator(press: Path, made: Made) -> None:
    config = made(*ON_PRESS, "procedure.rest_ms=10", "procedure.after_ms=30")
    columns, _ = plant_simulation.run_test(config, 3)
    found = stretches(columns)
    assert found[0.0] == pytest.approx((50, 0.4 / 50, 0.4)) and found[1.0] == (20, 0.4, 0.4)
    assert found[2.0] == (10, 0.4, 0.4) and found[3.0][0] == 400
    # from what the law gave last in equal steps to where it is declared to go, and there it stays
    assert found[4.0][0] == 70 and columns["voltage_v"][-30:] == pytest.approx(0.1)
    after = columns["voltage_v"][480 - 1 : 520]
    np.testing.assert_allclose(np.diff(after), (0.1 - after[0]) / 40, atol=1e-12)
    assert columns["time_s"][80] == 0.0 and columns["phase"][80] == 3.0
    on_rig, _ = run_test(made(*ON_PRESS, "procedure.rest_ms=10", "procedure.after_ms=30", "backend=rig", "rig=simulated"), 3)
    assert all(np.array_equal(columns[name], on_rig[name]) for name in columns)


def test_a_campaign_changes_how_long_and_how_far(press: Path, made: Made) -> None:
    config = made(*ON_PRESS, "procedure.phases.preload.voltage=0.2", "procedure.phases.hold.seconds=0.1")
    found = stretches(plant_simulation.run_test(config, 3)[0])
    assert found[0.0] == pytest.approx((50, 0.2 / 50, 0.2)) and found[1.0] == (100, 0.2, 0.2)
    assert planned_seconds(config, 0.4) == pytest.approx(0.4 + 0.05 + 0.1 + 0.04)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["procedure.phases.prelod.seconds=1"], "did you mean 'preload'?"),
        (["procedure.phases.preload.volts=1"], "did you mean 'voltage'?"),
        (["procedure.phases.preload.seconds=0"], "at least a sample, 0.001 s, is needed"),
        (["procedure.phases.preload.seconds=nan"], "at least a sample"),
        (["procedure.phases.preload.voltage=far"], "phase 'preload': voltage is 'far'; a number is needed"),
        (["procedure.phases.preload=3"], "procedure.phases.preload is 3; seconds and inputs with their values are needed"),
        (["procedure.phases.hold.voltage=12", "backend=rig", "rig=bench"], "phase 'hold' takes voltage to 12 V; it is limited to"),
    ],
)  # fmt: skip
def test_a_phase_that_cannot_be_is_refused_in_a_line_before_anything_moves(
    press: Path, words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("rigs/bench.py").write_text(RIG.replace("axis1", "press"))
    assert run(["plan", *ON_PRESS, *words]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('phases_before = Phase("a", 1.0)', "a tuple (Phase(NAME, SECONDS, {INPUT: VALUE}),) of 2 at most is needed"),
        ('phases_before = (Phase("a", 1.0), Phase("b", 1.0), Phase("c", 1.0))', "of 2 at most is needed"),
        ('phases_after = (Phase("a", 1.0), Phase("b", 1.0))', "of 1 at most is needed"),
        (
            'phases_before = (Phase("a", 1.0),)\n    phases_after = (Phase("a", 1.0),)',
            "a phase is called 'a'; a name of its own",
        ),
        ('phases_before = (Phase("rest", 1.0),)', "a phase is called 'rest'; a name of its own is needed"),
        ('phases_before = (Phase("a", 1e-5),)', "phase 'a': it takes 1e-05 s; at least a sample, 0.001 s, is needed"),
        ('phases_before = (Phase("a", 1.0, {"volts": 1.0}),)', "did you mean 'voltage'?"),
        ('phases_before = (Phase("a", 1.0, {"voltage": "1"}),)', "phase 'a': voltage is '1'; a number is needed"),
        ('phase_before = ("a",)', "did you mean 'phases_before'?"),
    ],
)
def test_phases_that_no_plant_can_have_are_refused_in_a_line(
    press: Path, text: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    press.write_text(PRESS.replace(PHASES, f"    {text}\n    period = 0.001"))
    assert run(["plan", *ON_PRESS]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_an_input_that_the_controller_does_not_command_is_no_part_of_a_phase(press: Path, made: Made) -> None:
    config = made(*ON_PRESS)
    with pytest.raises(UsageError, match="the controller does not command voltage; it commands nothing"):
        schedule_of(config, plant_in(config), [], 10)


def test_names_of_phases_stand_with_the_log(press: Path, made: Made) -> None:
    names = {"0": "preload", "1": "hold", "2": "rest", "3": "command and control", "4": "release"}
    assert phases_of(fields_of(plant_in(made(*ON_PRESS)))) == names


def test_what_a_plant_does_around_its_motion_is_shown(press: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plants", "press"]) == 0
    shown = [line.split() for line in capsys.readouterr().out.splitlines()]
    phases = {line[1]: " ".join(line[2:]) for line in shown if line[:1] == ["phase"]}
    assert phases == {
        "preload": "s 0.05 before the motion: voltage to 0.4 V",
        "hold": "s 0.02 before the motion: inputs stay",
        "release": "s 0.04 after the motion: voltage to 0.1 V",
    }


def test_a_signal_for_another_rig_has_the_phases(press: Path) -> None:
    words = ("plant=press", "controller=given", "trajectory=hold", "trajectory.duration=0.1", "repetitions=1")
    assert run(["plan", *words, "--signals", "out"]) == 0
    [path] = Path("out").glob("*.csv")
    signal = np.loadtxt(path, delimiter=",", skiprows=1)[:, 1]
    simulated = plant_simulation.run_test(Composer().compose(words).config, 1)[0]["voltage_v"]
    np.testing.assert_allclose(signal, simulated, atol=1e-8)


def test_a_plant_without_phases_has_the_kernel_that_it_had(press: Path, made: Made) -> None:
    without, with_phases = made(), made(*ON_PRESS)
    assert "if not running" not in simulator_of(without).law_text() and "if not running" in simulator_of(with_phases).law_text()
    columns = [prepare(one, 1).test.reference.shape[1] for one in (without, with_phases)]
    assert columns == [3, 5]


@pytest.mark.parametrize("law", [[1.0, 2.0, 3.0], [0.0, -5.0]])
def test_the_way_of_a_phase_begins_where_the_law_ended(law: list[float]) -> None:
    driven: Any = [[2.0, 0.5], [2.0, 1.0], *([[0.0, 0.0]] * len(law)), [0.0, 1 / 3], [0.0, 1 / 2], [0.0, 1.0]]
    times = Schedule(2, 2 + len(law), np.zeros(len(driven)), np.array(driven))
    found = times.along(np.array([9.0, 9.0, *law, 9.0, 9.0, 9.0]))
    assert found == pytest.approx([1.0, 2.0, *law, law[-1] * 2 / 3, law[-1] / 3, 0.0])
