"""On a terminal of any width no word of what is said is cut; in a file lines are whole."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hjcamp.errors import LONGEST_LIST, unknown

CALLS = (["plan", "campaign=controllers"], ["explain", "flor"], ["explain", "floor"], ["run", "campaign=nosuch"])


def shown(words: list[str], columns: int, folder: Path) -> list[str]:
    """Return the lines that a call shows on a terminal."""
    ours, theirs = pty.openpty()
    surroundings = {**os.environ, "COLUMNS": str(columns), "TERM": "xterm", "NO_COLOR": "1", "PYTHONWARNINGS": "ignore"}
    command = [sys.executable, "-m", "hjcamp", *words]
    with subprocess.Popen(command, cwd=folder, env=surroundings, stdin=theirs, stdout=theirs, stderr=theirs) as process:
        os.close(theirs)
        text = b""
        while True:
            try:
                part = os.read(ours, 65536)
            except OSError:
                break
            if not part:
                break
            text += part
        process.wait()
    os.close(ours)
    return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", text.decode()).replace("\r\n", "\n").splitlines()


@pytest.mark.parametrize("words", CALLS, ids=" ".join)
def test_no_word_is_cut_at_the_last_column(tmp_path: Path, words: list[str]) -> None:
    lines = shown(words, 72, tmp_path)
    assert lines and "Traceback" not in "".join(lines)
    for line in lines:
        # one word alone may be longer than the terminal is wide
        assert len(line.rstrip()) <= 72 or " " not in line.strip(), line


@pytest.mark.parametrize("number", [1, 20, 300])
def test_a_long_list_of_what_is_allowed_is_that_of_the_nearest(number: int) -> None:
    names = [f"word_{place:03d}" for place in range(number)]
    text = str(unknown("word", "word_000x", names))
    assert "did you mean 'word_000'" in text
    short = len(", ".join(names)) <= LONGEST_LIST
    assert text.count("word_") - 2 == (number if short else 12)
    assert (f"and {number - 12} that are less like it" in text) is not short
