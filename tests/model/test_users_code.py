"""A user's effect or controller inside a kernel: what cannot be compiled has file and line, what never ends has a name."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hjcamp
from hjcamp import cli
from hjcamp.controllers import find_controller, load_controllers
from hjcamp.errors import UsageError
from hjcamp.model.declare.law import law_function
from hjcamp.model.language import term_checks
from hjcamp.model.language.amount_formula import MATHEMATICS
from hjcamp.model.language.term_checks import check_law_compiles, users_files
from hjcamp.plants.pump_joint import simulation
from hjcamp.plants.pump_joint.controllers.pid import Pid
from hjcamp.plants.pump_joint.rig.control import RigControl

LAW = '''"""A law."""

from hjcamp.controllers.controller import Controller
from hjcamp.model.declare.law import Memory
from hjcamp.model.declare.parameter import Parameter


class Mine(Controller):
    """The error times a gain."""

    gain = Parameter("1", 8.0, (0.0, 100.0), text="gain")
    last = Memory()
    errors = Memory(size=3)

    @staticmethod
    def step(sample, parameter, memory):
        """Return the command."""
        error = sample.reference - sample.arm
        memory.last = error
        memory.errors[int(sample.index) % 3] = error
        {body}
'''
RIGHT = "return parameter.gain * error, sample.feedforward"
WRONG = {
    "a text": ("return 'x' + error, 0.0", 21, "numba cannot compile it"),
    "a name that is none": ("return error * nowhere, 0.0", 21, "numba cannot compile it"),
    "an import": ("import os\n        return os.getpid() * error, 0.0", 21, "numba cannot compile it"),
    "one number": ("return error", 21, "2 numbers are needed on every way through it: pid, feedforward"),
    "three numbers": ("return error, 0.0, 0.0", 21, "2 numbers are needed"),
    "a list": ("return [error], 0.0", 21, "2 numbers are needed"),
    "sometimes nothing": ("if error > 0.0:\n            return error, 0.0", 22, "2 numbers are needed"),
}
SLOW = '''"""An effect that does not end where the arm stands between two angles."""

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Slow(Effect):
    """A spring."""

    subsystem = "joint"
    stiffness = Parameter("N/rad", 1.0, (0.1, 10.0), text="stiffness", off=0.0)

    @staticmethod
    def load_force(arm_angle, {quantity}, stiffness):
        """Return the force."""
        x = {quantity}
        while {low} < x < {high}:
            x = {low} + 0.5 * (x - {low}) + {step}
        return -stiffness * arm_angle
'''


def law(folder: Path, body: str) -> type[Any]:
    (folder / "controllers").mkdir()
    (folder / "controllers" / "mine.py").write_text(LAW.format(body=body))
    return load_controllers()["mine"]


@pytest.mark.parametrize("what", WRONG)
def test_a_controller_that_cannot_be_compiled(what: str, empty_folder: Path) -> None:
    body, line, told = WRONG[what]
    mine = law(empty_folder, body)
    with pytest.raises(UsageError) as caught:
        check_law_compiles(mine, tuple(MATHEMATICS))
    said = str(caught.value)
    assert said.startswith(f"{empty_folder}/controllers/mine.py: line {line}: controller mine: "), said
    assert told in said and "\n" not in said, said


@pytest.mark.parametrize("way", ["simulation", "rig"])
def test_it_is_said_in_a_run_and_on_a_rig(way: str, empty_folder: Path) -> None:
    mine = law(empty_folder, WRONG["a text"][0])
    with pytest.raises(UsageError, match=r"mine\.py: line 21: controller mine: numba cannot compile it"):
        if way == "rig":
            RigControl(mine, mine.vector({}), np.zeros(11), np.zeros((2, 4)), np.zeros(2), 1e-3)
        else:
            _ = simulation._simulator((), mine).kernel


def test_a_controller_that_can(empty_folder: Path) -> None:
    mine = law(empty_folder, RIGHT)
    check_law_compiles(mine, tuple(MATHEMATICS))
    assert users_files([mine, Pid]) == f"controller mine ({empty_folder}/controllers/mine.py)"
    assert users_files([Pid]) == ""


def test_the_function_of_a_law_is_what_the_kernel_runs() -> None:
    function: Callable[..., Any] = law_function(Pid, {})
    memory = Pid.fresh_memory()
    pid, ahead = function(0.1, 0.0, 0.0, 0.0, 0.2, 1e-3, 0, Pid.vector({}), memory)
    assert pid == pytest.approx(8.5 * (1.05 * 0.1 + 70.0 * 1e-4)) and ahead == 0.2
    assert function.__code__.co_filename.endswith("controllers/pid.py")
    assert find_controller("pid") is Pid


def test_an_effect_that_never_ends_where_units_are_looked_at(
    empty_folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(term_checks, "LOOKING_S", 0.5)
    (empty_folder / "effects").mkdir()
    text = SLOW.format(quantity="time", low=0.31, high=0.9, step=0.1)
    (empty_folder / "effects" / "slow.py").write_text(text)
    assert cli.run(["plan", "+effects.slow={}", "repetitions=1"]) == 2
    assert "effect slow, method 'load_force' did not end within 0.5 s" in capsys.readouterr().err


@pytest.mark.study
def test_an_effect_that_never_ends_at_certain_values(empty_folder: Path) -> None:
    (empty_folder / "effects").mkdir()
    # The pressure of the preload: a value that nothing tries beforehand.
    text = SLOW.format(quantity="pressure1", low=2e5, high=3e5, step=1e3)
    (empty_folder / "effects" / "slow.py").write_text(text)
    assert cli.run(["plan", "+effects.slow={}", "repetitions=1"]) == 0, "what ends where it is tried is taken"
    words = ["run", "+effects.slow={}", "repetitions=2", "workers=1", "run_dir=one"]
    script = (
        f"from hjcamp import cli\nfrom hjcamp.model.language import term_checks\nterm_checks.KERNEL_S = 2.0\n"
        f"raise SystemExit(cli.run({words}))\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1])}
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, timeout=500)
    assert done.returncode == 2, done.stderr
    told = done.stderr.strip().splitlines()[-1]
    assert "one test with effect slow (" in told and "effects/slow.py) did not end within 2 s of computing" in told
    assert not list(empty_folder.rglob("*.mcap*")), "no part of a log is left"
