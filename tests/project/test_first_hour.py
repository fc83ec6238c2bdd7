"""Each command of the README's three first hours works as it stands there."""

from __future__ import annotations

import re
import shlex
import socket
from pathlib import Path
from typing import Any

import pytest

import hjcamp.effects
from hjcamp import cli
from hjcamp.plants.pump_joint.tour import spindle

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def commands(heading: str) -> list[list[str]]:
    """Return the words of the commands below a heading of the README."""
    found = re.search(rf"^### {heading}\n.*?^```\n(.*?)^```", README, re.DOTALL | re.MULTILINE)
    assert found, heading
    lines = [shlex.split(line) for line in found[1].splitlines()]
    assert len(lines) == 5 and all(words[0] == "hjcamp" for words in lines)
    return [words[1:] for words in lines]


@pytest.fixture
def short_recordings(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first 6 s of each recording of the spindle: what they hold is asked of the tour and the gallery."""
    short = tmp_path_factory.mktemp("spindle")
    for file in spindle.FILES.iterdir():
        lines = file.read_text(encoding="utf-8").splitlines(True)
        (short / file.name).write_text("".join(lines[:601]), encoding="utf-8")
    monkeypatch.setattr(spindle, "FILES", short)


@pytest.fixture
def few_laws(monkeypatch: pytest.MonkeyPatch) -> None:
    """A library of four laws, the hidden one among them: that it is named among all is asked of the tour and the gallery."""
    every = hjcamp.effects.effect_files()
    few = {name: every[name] for name in ("quadratic_drag", "viscous_asymmetry", "gravity_load", "sensor_lag")}
    monkeypatch.setattr(hjcamp.effects, "effect_files", lambda folders=None: few)


@pytest.fixture
def no_network(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let nothing be reached but this machine."""
    connect = socket.socket.connect

    def here(one: socket.socket, address: Any) -> None:
        if isinstance(address, tuple) and address[0] not in ("127.0.0.1", "::1", "localhost"):
            raise AssertionError(f"{address} was to be reached")
        connect(one, address)

    monkeypatch.setattr(socket.socket, "connect", here)


@pytest.mark.usefixtures("no_network", "short_recordings")
@pytest.mark.parametrize("heading", ["A model of something of your own", "At the bench", "In CI"])
def test_the_five_commands_of_a_first_hour(
    empty_folder: Path,
    heading: str,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    request: pytest.FixtureRequest,
) -> None:
    if heading == "A model of something of your own":
        request.getfixturevalue("few_laws")
    monkeypatch.setenv("HYDRA_FULL_ERROR", "1")
    for words in commands(heading):
        assert cli.run(words) == 0, f"{shlex.join(words)}: {capfd.readouterr().err}"
    if heading == "In CI":
        assert (empty_folder / "summary.md").is_file() and (empty_folder / "junit.xml").is_file()


def test_there_are_three_of_them() -> None:
    part = README[README.index("## The first hour") : README.index("## The joint of the reference")]
    assert re.findall(r"^### (.*)", part, re.MULTILINE) == ["A model of something of your own", "At the bench", "In CI"]
