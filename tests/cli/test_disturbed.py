"""The study of disturbed calls sees what it is to see: processes that outlive theirs, files that are not whole, a lost log."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import disturbed_commands
import pytest
from disturbed_commands import faults, logs_of, outlive

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads the processes of Linux")
CHILD = "import subprocess, sys\nchild = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(@)'])\nprint(flush=True)\n"


@pytest.mark.parametrize(("seconds", "found"), [(60, True), (0, False)])
def test_processes_that_outlive_theirs_are_seen_and_ended(monkeypatch: pytest.MonkeyPatch, seconds: int, found: bool) -> None:
    monkeypatch.setattr(disturbed_commands, "ORPHANS_S", 0.3 if found else 60.0)
    code = CHILD.replace("@", str(seconds)) + "sys.stdin.read()"
    with subprocess.Popen(
        [sys.executable, "-c", code], start_new_session=True, stdout=subprocess.PIPE, stdin=subprocess.PIPE
    ) as first:
        assert first.stdout is not None
        first.stdout.read(1)
        first.kill()
        assert outlive(first.pid) is found
    assert not outlive(first.pid)


@pytest.mark.parametrize(
    ("way", "code", "said", "file", "found"),
    [
        ("kill", -9, "", "", []),
        ("interrupt", 130, "interrupted", "", []),
        ("memory", -9, "", "", ["exit code -9"]),
        ("memory", 1, "", "", ["no message"]),
        ("disk", 1, "hjcamp: internal error: KeyError", "", ["internal error"]),
        ("disk", None, "", "", ["did not end"]),
        ("files", 1, "hjcamp: too many", "answer.json.part", ["left answer.json.part"]),
        ("kill", -9, "", "answer.json.part", []),
        ("kill", -9, "", "answer.json", ["answer.json: Expecting value: line 1 column 1 (char 0)"]),
        ("kill", -9, "", "page.html", ["page.html: cut off"]),
    ],
)
def test_what_must_not_happen_is_found(
    tmp_path: Path, way: str, code: int | None, said: str, file: str, found: list[str]
) -> None:
    if file:
        (tmp_path / file).write_text("")
    assert faults(way, code, said, tmp_path, {}) == found
    (tmp_path / "gone.mcap").write_bytes(b"")
    logs = logs_of(tmp_path)
    (tmp_path / "gone.mcap").unlink()
    assert "a log was lost or changed" in faults(way, code, said, tmp_path, logs)
