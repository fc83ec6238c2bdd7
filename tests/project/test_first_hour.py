"""Each command of the README's three first hours works as it stands there."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from hjcamp import cli

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def commands(heading: str) -> list[list[str]]:
    """Return the words of the commands below a heading of the README."""
    found = re.search(rf"^### {heading}\n.*?^```\n(.*?)^```", README, re.DOTALL | re.MULTILINE)
    assert found, heading
    lines = [shlex.split(line) for line in found[1].splitlines()]
    assert len(lines) == 5 and all(words[0] == "hjcamp" for words in lines)
    return [words[1:] for words in lines]


@pytest.mark.parametrize("heading", ["A model of something of your own", "At the bench", "In CI"])
def test_the_five_commands_of_a_first_hour(
    empty_folder: Path, heading: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HYDRA_FULL_ERROR", "1")
    for words in commands(heading):
        assert cli.run(words) == 0, f"{shlex.join(words)}: {capfd.readouterr().err}"
    if heading == "In CI":
        assert (empty_folder / "summary.md").is_file() and (empty_folder / "junit.xml").is_file()


def test_there_are_three_of_them() -> None:
    part = README[README.index("## The first hour") : README.index("## The joint of the reference")]
    assert re.findall(r"^### (.*)", part, re.MULTILINE) == ["A model of something of your own", "At the bench", "In CI"]
