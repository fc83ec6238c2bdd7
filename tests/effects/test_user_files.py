"""A user's Python file, whatever is in it: one message with file and line, exit code 2, and the program goes on or ends."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from wheel_plant import WHEEL

import hjcamp
from hjcamp import cli
from hjcamp.effects import faults_of_own, load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.effect import Effect
from hjcamp.model.files import user_file
from hjcamp.model.files.time_limit import RunLimit, time_limit
from hjcamp.model.language import term_checks
from hjcamp.model.language.amount_formula import MATHEMATICS
from hjcamp.model.language.term_checks import check_calls, check_compiles
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.effect_checks import EffectBench

KINDS = {"effects": ["effects"], "controllers": ["plan"], "trajectories": ["plan"]}
FILES: dict[str, tuple[bytes, str]] = {
    "ends quietly": (b"\nraise SystemExit(0)\n", "line 2: this file ends the program"),
    "ends with words": (b"import sys\n\nsys.exit('bye')\n", "line 3: this file ends the program (SystemExit: bye)"),
    "another exception": (b"raise GeneratorExit\n", "line 1: cannot be loaded: GeneratorExit"),
    "in a function": (b"def f():\n    1 / 0\n\nf()\n", "line 2: cannot be loaded: ZeroDivisionError"),
    "not UTF-8": (b"# degrees\n# \xb0C\n", "line 2: this is not UTF-8 text"),
    "a zero byte": (b"x = 1\nx = '\x00'\n", "null bytes"),
    "endless": (b"x = 1\nwhile x:\n    pass\n", "did not end within 0.3 s"),
    "endless, and stubborn": (
        b"import time\nfor again in (1, 2):\n  try:\n    while True: pass\n  except BaseException: pass\n",
        "did not end within 0.3 s",
    ),
    "a missing package": (b"import nowhere_to_be_found\n", "line 1: cannot be loaded: ModuleNotFoundError"),
}
SPRING = '''from hjcamp.effect import Effect, Parameter


class Mine(Effect):
    """A spring."""

    subsystem = "joint"
    stiffness = Parameter("N/rad", 0.5, (0.0, 50.0), text="stiffness", off=0.0)

    @staticmethod
    def load_force(arm_angle, stiffness):
        x = 1.0
        {body}
'''
BODIES = {
    "a list": ("return [x]", 13, "it gives a list; a number is needed"),
    "nothing": ("x = 2.0", 10, "it gives nothing; a number is needed"),
    "sometimes a text": ("return x if arm_angle < 1e9 else [x]", 13, "numba cannot compile it: Cannot unify"),
    "a type that changes": (
        "x = x if arm_angle < 1e9 else 'a'\n        return x + 1.0",
        13,
        "numba cannot compile it: ",
    ),
    "a bytecode": ("a, *b = (x, x)\n        return a", 13, "numba cannot compile it: Use of unsupported opcode"),
    "an empty dictionary": (
        "y = {}\n        return x",
        13,
        "numba cannot compile it: Cannot infer the type of variable",
    ),
    "an end": ("raise SystemExit(0)", 13, "SystemExit: 0"),
    "a wrong call": ("return abs(x, x)", 13, "TypeError: abs() takes exactly one argument"),
    "endless": ("while x > 0.0:\n            x += 1.0\n        return x", 10, "did not end within 0.3 s"),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", FILES)
def test_one_message_names_file_and_line(
    kind: str, what: str, empty_folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(user_file, "LOADING_S", 0.3 if "endless" in what else 15.0)
    content, told = FILES[what]
    path = empty_folder / kind / "mine.py"
    path.parent.mkdir()
    path.write_bytes(content)
    assert cli.run(KINDS[kind]) == 2
    said = capsys.readouterr()
    assert str(path) in said.err and told in said.err, said.err
    assert said.out == "" and len(said.err.strip().splitlines()) == 1, said.err


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["my effect.py", "class.py", "2nd.py", "a-b.py", "naïve.py"])
def test_a_file_name_that_is_no_name(kind: str, name: str, empty_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (empty_folder / kind).mkdir()
    (empty_folder / kind / name).write_text("")
    assert cli.run(KINDS[kind]) == 2
    said = capsys.readouterr().err
    assert f"{kind}/{name}" in said and "Allowed: letters, digits and _" in said, said


def test_a_folder_and_a_lost_link_in_the_place_of_a_file(empty_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (empty_folder / "effects" / "mine.py").mkdir(parents=True)
    assert cli.run(["effects"]) == 2
    assert "mine.py: cannot be read" in capsys.readouterr().err
    (empty_folder / "effects" / "mine.py").rmdir()
    (empty_folder / "effects" / "mine.py").symlink_to("nowhere")
    assert cli.run(["effects"]) == 2
    assert "mine.py: cannot be read" in capsys.readouterr().err


def mine(folder: Path, body: str) -> type[Effect]:
    """Return the effect with this body."""
    folder.mkdir()
    (folder / "mine.py").write_text(SPRING.format(body=body))
    return load_effects([folder])["mine"]


@pytest.mark.parametrize("what", BODIES)
def test_a_method_that_is_no_formula(what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(term_checks, "CALLING_S", 0.3 if what == "endless" else 30.0)
    body, line, told = BODIES[what]
    effect = mine(tmp_path / "effects", body)
    with pytest.raises(UsageError) as caught:
        check_calls(effect, tuple(MATHEMATICS))
        check_compiles(effect, tuple(MATHEMATICS))
    said = str(caught.value)
    assert said.startswith(f"{tmp_path}/effects/mine.py: line {line}: effect mine, method 'load_force'"), said
    assert told in said and "\n" not in said, said


@pytest.mark.parametrize(
    "body", ["return -stiffness * arm_angle", "return sin(arm_angle)", "return 1", "return 1.0 / arm_angle"]
)
def test_a_method_that_is_a_formula(body: str, tmp_path: Path) -> None:
    effect = mine(tmp_path / "effects", body)
    check_calls(effect, tuple(MATHEMATICS))
    check_compiles(effect, tuple(MATHEMATICS))


@pytest.mark.parametrize("command", [("effects", "test", "mine"), ("run", "+effects.mine={}", "repetitions=1")])
def test_commands_say_it_before_they_compile(
    command: tuple[str, ...], empty_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine(empty_folder / "effects", BODIES["a list"][0])
    assert cli.run(list(command)) in (1, 2)
    said = capsys.readouterr()
    assert "mine.py: line 13: effect mine, method 'load_force': it gives a list" in said.out + said.err
    assert "internal error" not in said.out + said.err


def test_a_time_limit_leaves_what_ends_alone() -> None:
    for _ in range(200):
        with time_limit(30.0, "this"):
            pass
    deadline = time.monotonic() + 10.0
    while threading.active_count() > 20 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert threading.active_count() <= 20, "watchers stay behind"
    with pytest.raises(ZeroDivisionError), time_limit(30.0, "this"):
        _ = 1 / 0


def in_a_process(script: str) -> subprocess.CompletedProcess[str]:
    """Run a script of its own."""
    environment = {**os.environ, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1])}
    return subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, timeout=60)


STUBBORN = """
from hjcamp.model.files.time_limit import time_limit
with time_limit(0.2, "the file"):
    while True:
        try:
            while True:
                pass
        except BaseException:
            pass
"""
ENDLESS_KERNEL = """
from numba import njit
from hjcamp.model.files.time_limit import RunLimit

@njit(nogil=True)
def endless(x):
    while x > 0.0:
        x += 1e-300
    return x

with RunLimit(0.5, "effect mine")():
    endless(1.0)
"""


@pytest.mark.parametrize("script", [STUBBORN, ENDLESS_KERNEL])
def test_what_nothing_else_can_stop_ends_the_process(script: str) -> None:
    done = in_a_process(script)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and "did not end within" in done.stderr, done.stderr


def test_compiling_does_not_count() -> None:
    from numba.core.compiler_lock import global_compiler_lock

    ended: list[str] = []
    limit = RunLimit(0.3, "this", ended.append)
    with limit(), global_compiler_lock:
        begin = time.process_time()
        while time.process_time() - begin < 0.9:
            pass
    assert not ended
    with limit():
        begin = time.process_time()
        while time.process_time() - begin < 0.9:
            pass
    assert len(ended) == 1 and "this did not end within 0.3 s of computing" in ended[0]


def test_every_test_of_the_checks_is_watched(tmp_path: Path) -> None:
    watched: list[Callable[..., object]] = []

    class Model:
        def vector(self, values: object) -> np.ndarray:
            return np.zeros(1)

        def follow(self, p: np.ndarray, course: object) -> object:
            assert watched and watched[-1] == "at work"
            return type("Followed", (), {"readings": np.zeros((1, 1))})

    class Watch:
        def __enter__(self) -> None:
            watched.append("at work")  # type: ignore[arg-type]

        def __exit__(self, *arguments: object) -> None:
            watched.append("done")  # type: ignore[arg-type]

    effect = mine(tmp_path / "effects", "return x")
    bench = EffectBench(effect, Model(), PumpJoint.courses(), Watch)  # type: ignore[arg-type]
    bench.readings(next(iter(bench.courses.values())), 1.0)
    assert watched == ["at work", "done"]


def test_faults_of_own_effects_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    law = "\n\n    @staticmethod\n    def {slot}(strength):\n        return strength\n"
    head = "from hjcamp.model.effect import Effect\nfrom hjcamp.model.parameter import Parameter\n\n\nclass {title}(Effect):\n"
    head += (
        '    r"""A push.\n\n    .. math:: F = s\n\n    Seen as: x.\n    Not for: y.\n    Source: z.\n    """\n\n    {kind}\n'
    )
    head += '    strength = Parameter("{unit}", 0.1, (0.0, 1.0), text="a push", off=0.0)\n'
    (tmp_path / "effects").mkdir()
    files = {
        "wind": ("Wind", "force", 'acts_on = "body"', "force*s"),
        "gust": ("Gust", "load", 'plant = "wheel"\n    subsystem = "drive"', "m"),
        "shove": ("Shove", "force", 'acts_on = "body"', "force"),
        "other": ("Other", "motor_load", 'plant = "servo"\n    subsystem = "drive"', "m"),
    }
    for name, (title, slot, kind, unit) in files.items():
        (tmp_path / "effects" / f"{name}.py").write_text((head + law).format(title=title, slot=slot, kind=kind, unit=unit))
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "wheel.py").write_text(WHEEL)
    monkeypatch.chdir(tmp_path)
    left_out, mixed = faults_of_own(find_plant("wheel"))
    assert left_out.startswith("effect wind, method ") and left_out.endswith(": it is left out")
    assert mixed.startswith("effect gust, method 'load' gives m, but the slot is in N*m") and "amounts may be wrong" in mixed
