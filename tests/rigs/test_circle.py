"""The circle of docs/circle.md, its lines as they stand: up to the first comparison in every run of the tests, whole as a study."""

from __future__ import annotations

import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from lab_of_rigs import AXIS

from hjcamp import cli

PAGE = Path(__file__).parents[2] / "docs" / "circle.md"
LINES = [shlex.split(line)[1:] for line in re.findall(r"^    (hjcamp .*)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)]
SERVE = next(words for words in LINES if words[:2] == ["rig", "serve"])


@pytest.fixture
def rig(lab: Path) -> Iterator[subprocess.Popen[str]]:
    """Serve the rig of the page, with the plant of its first step."""
    assert LINES[0] == ["plants", "new", "axis1"]
    (lab / "plants" / "axis1.py").write_text(AXIS)
    server = subprocess.Popen([sys.executable, "-m", "hjcamp", *SERVE], stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None and "is served at socket://127.0.0.1:" in server.stdout.readline()
    yield server
    if server.poll() is None:
        server.send_signal(signal.SIGTERM)
        server.communicate(timeout=30.0)


@pytest.mark.skipif(sys.platform == "win32", reason="SIGTERM ends a process there")
def test_the_circle_up_to_the_comparison(rig: subprocess.Popen[str], capfd: pytest.CaptureFixture[str]) -> None:
    runs = [words for words in LINES if words[0] == "run"]
    short = ["trajectory.duration=2", "repetitions=2"]
    assert cli.run([*runs[0], *short]) == 0, capfd.readouterr().err
    assert cli.run(["compare", "runs/first"]) == 0, capfd.readouterr().err
    out = capfd.readouterr().out
    told = re.search(r"published .* ([\d.]+)\n", out)
    assert told is not None and float(told[1]) > 2.0, out  # a spring of 2000 N/m is missed
    rig.send_signal(signal.SIGTERM)
    assert "hidden   spring: stiffness 2000 N/m" in rig.communicate(timeout=30.0)[0]


@pytest.mark.study
def test_the_whole_circle(rig: subprocess.Popen[str], capfd: pytest.CaptureFixture[str]) -> None:
    for words in LINES[2:]:
        assert cli.run(words) == 0, (words, capfd.readouterr().err)
    out = capfd.readouterr().out
    errors = [float(found[1]) for found in re.finditer(r"^  (?:published|with_spring) .* ([\d.]+)$", out, re.MULTILINE)]
    assert errors[-1] < 0.5 * errors[-2]
