"""The entry point: help without heavy imports, exit codes, one message for every error."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from hjcamp import cli, commands
from hjcamp.errors import HjcampError, RigStopped

if TYPE_CHECKING:
    from conftest import Call

HEAVY = (
    "hydra", "omegaconf", "numba", "numpy", "polars", "matplotlib", "scipy", "mcap", "nidaqmx", "joblib", "rich", "pygments",
)  # fmt: skip
ROOT = Path(__file__).parents[2]


def test_help_imports_nothing_heavy() -> None:
    code = f"""import sys; from hjcamp import cli; c = cli.run(['--help'])
print(c, [name for name in {HEAVY} if name in sys.modules])"""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "0 []"


def test_help_lists_every_command(call: Call) -> None:
    code, out, _ = call("--help")
    assert code == 0
    for name in ("run", "plan", "ls", "show", "resume", "report", "doctor", "log", "import"):
        assert name in out
    assert call().out == out


def test_the_first_commands_can_be_copied_from_the_help(call: Call) -> None:
    lines = [line.split("hjcamp ", 1)[1] for line in call("--help").out.splitlines() if "hjcamp plan " in line]
    assert lines == ["plan campaign=robustness_vertical"]


@pytest.mark.parametrize("name", sorted(commands.command_files()))
def test_every_command_has_one_line_and_help(call: Call, name: str) -> None:
    assert commands.one_line(commands.command_files()[name])
    assert call(name, "--help").code == 0


def test_version(call: Call) -> None:
    assert call("--version").out.startswith("hjcamp ")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["runn"], "did you mean 'run'"),
        (["--colour"], "No such option"),
        (["plan", "--colour"], "(see hjcamp plan --help)"),
        (["show"], "Missing argument"),
        (["show", "nothing"], "not found"),
        (["resume", "nothing"], "not found"),
        (["report", "nothing"], "nothing"),
        (["log", "verify", "nothing"], "nothing"),
        (["log"], "log: give one of info, verify, recover, export, view"),
        (["rig"], "rig: give one of serve, check, unlock"),
        (["ls", "payload"], "KEY=VALUE"),
        (["import", "nothing.csv", "--map", "nothing.yaml"], "nothing"),
    ],
)
def test_unusable_calls_exit_with_two(call: Call, arguments: list[str], words: str) -> None:
    code, _, err = call(*arguments)
    assert code == 2
    assert words in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (HjcampError("it broke"), 1, "it broke"),
        (RigStopped("made safe"), 3, "made safe"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (MemoryError(), 1, "memory"),
        (OSError(28, "No space left on device", "file"), 1, "No space left on device: file"),
        (BrokenPipeError(), 0, ""),
        (SystemExit(3), 3, ""),
        (ZeroDivisionError("oops"), 1, "internal error: ZeroDivisionError: oops; details in "),
    ],
)
def test_every_error_is_one_message(
    call: Call, monkeypatch: pytest.MonkeyPatch, error: BaseException, code: int, words: str
) -> None:
    def fails(*arguments: object, **options: object) -> None:
        raise error

    monkeypatch.setattr(cli, "app", fails)
    monkeypatch.setattr(cli, "_close_stdout", lambda: None)
    answer = call("ls")
    assert answer.code == code
    assert words in answer.err
    assert "Traceback" not in answer.err
    if isinstance(error, ZeroDivisionError):
        details = Path(answer.err.rsplit(" ", 1)[-1].strip())
        assert "ZeroDivisionError: oops" in details.read_text()
        details.unlink()


def test_doctor_is_content(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    code, out, _ = call("doctor")
    assert code == 0, out
    assert "nidaqmx" in out and "campaigns" in out
    monkeypatch.setenv("HJCAMP_CONF", "no/such/folder")
    assert call("doctor").code == 1


def test_ctrl_c_that_the_command_line_library_makes_a_number_is_said(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli, "app", lambda *arguments, **options: 130)
    code, _, err = call("plan")
    assert code == 130 and "interrupted" in err
