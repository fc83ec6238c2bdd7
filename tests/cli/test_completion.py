"""Completion as the shells ask for it; bash splits its words at ``=``."""

from __future__ import annotations

import os
import pty
import select
import shutil
import sys
import time
from pathlib import Path

import pytest

from hjcamp import cli
from hjcamp.commands import command_files, load
from hjcamp.commands.shared.complete_bash import whole_words

ROOT = Path(__file__).parents[2]


def bash(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], *pieces: str) -> list[str]:
    """Return the answers for a command line that bash has split into ``pieces``, the last under the cursor."""
    monkeypatch.setenv("_HJCAMP_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "\n".join(("hjcamp", *pieces)))
    monkeypatch.setenv("COMP_CWORD", str(len(pieces)))
    capfd.readouterr()
    assert cli.answer_bash() == 0
    out, err = capfd.readouterr()
    assert err == ""
    return out.split("\n") if out else []


@pytest.mark.parametrize(
    ("pieces", "words", "before"),
    [
        (["hjcamp", "run", "campaign", "=", "ro"], ["hjcamp", "run", "campaign=ro"], "campaign="),
        (["hjcamp", "run", "campaign", "="], ["hjcamp", "run", "campaign="], "campaign="),
        (["hjcamp", "run", "campaign", "=", ""], ["hjcamp", "run", "campaign="], "campaign="),
        (["hjcamp", "run", "camp"], ["hjcamp", "run", "camp"], ""),
        (["hjcamp", "run", "campaign=ro"], ["hjcamp", "run", "campaign=ro"], ""),
        (["hjcamp", "run", "a", "=", "b", "c", "=", "d"], ["hjcamp", "run", "a=b", "c=d"], "c="),
        (["hjcamp", "run", "a", "=", "b", ""], ["hjcamp", "run", "a=b", ""], ""),
        (
            ["hjcamp", "d", "--cluster", "tcp", ":", "//h", ":", "1"],
            ["hjcamp", "d", "--cluster", "tcp://h:1"],
            "tcp://h:",
        ),
        (["hjcamp"], ["hjcamp"], ""),
    ],
)
def test_the_pieces_of_bash_are_words_again(pieces: list[str], words: list[str], before: str) -> None:
    assert whole_words(pieces) == (words, before)


@pytest.mark.parametrize(
    ("pieces", "answers"),
    [
        (["run", "campaign", "=", "ro"], ["robustness_horizontal", "robustness_vertical"]),
        (["plan", "controller", "=", "ff"], ["ffwd_pid", "ffwd_pva"]),
        (["plan", "+effects.x", "=", "1", "controller", "=", "pi"], ["pid"]),
        (["run", "controller.positive.k"], [f"controller.positive.{gain}=" for gain in ("kd", "ki", "kp")]),
        (["compare", "--model", "pub"], ["published"]),
        (["compare", "--model", "=", "pub"], ["published"]),
        (["diagnose", "--effort", ""], ["quick", "standard", "thorough"]),
        (["next", "--effort", "st"], ["standard"]),
        (["next", "--rivals", "leakage,no"], ["leakage,nothing"]),
        (["report", "--against", "pub"], ["published"]),
        (["report", "--against", "runs/con"], ["runs/controllers/one"]),
        (["diff", "runs/controllers/one", "runs/con"], ["runs/controllers/one"]),
        (["paper", "ans"], ["answer.json"]),
        (["paper", "--style", "els"], ["elsevier"]),
        (["history", "campaign", "=", "robustness_v"], ["robustness_vertical"]),
        (["history", "rms"], ["rmse1_deg", "rmse2_deg"]),
        (["history", "--over", ""], ["commits", "runs"]),
        (["ls", "state", "=", "com"], ["complete"]),
        (["ls", "--columns", "git,+pay"], ["git,+payload"]),
        (["ls", "--sort", "rmse1"], ["rmse1_deg"]),
        (["plants", "valv"], ["valve_joint"]),
        (["plants", "ne"], ["new"]),
        (["plants", "test", "valv"], ["valve_joint"]),
        (["effects", "--plant", "valv"], ["valve_joint"]),
        (["effects", "new", "x", "--on", "cont"], ["contact"]),
        (["diagnose", "--only", "leakage,stribeck_f"], ["leakage,stribeck_friction"]),
        (["calibrate", "--only", "pump", "=", "pump1"], ["pump1"]),
        (["import", "--map", "mi"], ["mine.yaml"]),
        (["plan", "--json", "ans"], ["answer.json"]),
        (["sizing", "cap"], ["capability"]),
        (["report", "--check", ""], ["default", "mine.yaml", "runs/"]),
        (["effects", "leak"], ["leakage"]),
        (["effects", "ne"], ["new"]),
        (["effects", "test", "leak"], ["leakage"]),
        (["effects", "new", ""], []),
        (["effects", "leakage", "trajectory", "=", "ramp_"], ["ramp_neg", "ramp_pos"]),
        (["add", "leak"], ["leakage"]),
        (["tune", "--from", "zieg"], ["ziegler_nichols"]),
        *(([command, "runs/con"], ["runs/controllers/one"]) for command in ("compare", "diagnose", "add", "next")),
        *(([command, "runs/con"], ["runs/controllers/one"]) for command in ("report", "show", "resume", "calibrate")),
        (["log", "verify", "one."], ["one.mcap"]),
        (["rep"], ["report", "repository"]),
    ],
)
def test_bash_is_answered(
    empty_folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    pieces: list[str],
    answers: list[str],
) -> None:
    run = empty_folder / "runs" / "controllers" / "one"
    run.mkdir(parents=True)
    for name in ("runs/controllers/one/plan.json", "mine.yaml", "one.mcap", "answer.json"):
        (empty_folder / name).write_text("")
    assert bash(monkeypatch, capfd, *pieces) == answers


def test_zsh_and_fish_get_whole_words(
    empty_folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("_TYPER_COMPLETE_ARGS", "hjcamp run campaign=ro")
    monkeypatch.setenv("_TYPER_COMPLETE_FISH_ACTION", "get-args")
    for shell in ("zsh", "fish"):
        monkeypatch.setenv("_HJCAMP_COMPLETE", f"complete_{shell}")
        cli.run([])
        out = capfd.readouterr().out
        assert "campaign=robustness_horizontal" in out and "campaign=robustness_vertical" in out


def test_a_broken_configuration_prints_nothing_into_the_prompt(
    empty_folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    (empty_folder / "conf" / "pump").mkdir(parents=True)
    (empty_folder / "conf" / "pump" / "pump2.yaml").write_text("a: [")
    assert bash(monkeypatch, capfd, "run", "controller.positive.k") == []


def test_without_a_question_of_a_shell_nothing_is_added(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("_HJCAMP_COMPLETE", raising=False)
    assert {param.name for param in load(command_files()["compare"]).params} >= {"paths", "model"}


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_a_live_bash_completes_overrides_runs_models_effects_and_files(empty_folder: Path) -> None:
    """Type into an interactive bash: what the Tab key adds is on the line."""
    place = empty_folder / "bin"
    place.mkdir()
    (place / "hjcamp").write_text(f"#!/bin/sh\nexec '{sys.executable}' -m hjcamp \"$@\"\n")
    (place / "hjcamp").chmod(0o755)
    run = empty_folder / "runs" / "controllers" / "one"
    run.mkdir(parents=True)
    for name in ("runs/controllers/one/plan.json", "measured.mcap"):
        (empty_folder / name).write_text("")
    (empty_folder / "rc").write_text(
        "PS1='ready> '\nbind 'set enable-bracketed-paste off'\neval \"$(_HJCAMP_COMPLETE=source_bash hjcamp)\"\n"
    )
    environment = {**os.environ, "PATH": f"{place}:{os.environ['PATH']}", "TERM": "dumb", "PYTHONPATH": str(ROOT)}
    environment["HJCAMP_CONF"] = ""
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(empty_folder)
        os.execvpe("bash", ["bash", "--noprofile", "--rcfile", str(empty_folder / "rc"), "-i"], environment)
    try:
        read_until(terminal, "ready> ")
        for typed, wanted in (
            ("hjcamp run campaign=robustness_v", "campaign=robustness_vertical"),
            ("hjcamp compare runs/con", "runs/controllers/one"),
            ("hjcamp compare --model=pub", "--model=published"),
            ("hjcamp add leak", "add leakage"),
            ("hjcamp log info mea", "measured.mcap"),
        ):
            os.write(terminal, f"{typed}\t".encode())
            assert wanted in read_until(terminal, wanted)
            os.write(terminal, b"\x15")  # Ctrl-U takes the line away
    finally:
        os.kill(pid, 9)
        os.waitpid(pid, 0)
        os.close(terminal)


def read_until(terminal: int, wanted: str, seconds: float = 60.0) -> str:
    seen = ""
    end = time.monotonic() + seconds
    while wanted not in seen and time.monotonic() < end:
        if select.select([terminal], [], [], 0.5)[0]:
            seen += os.read(terminal, 4096).decode(errors="replace")
    assert wanted in seen, seen
    return seen
