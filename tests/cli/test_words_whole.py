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

ESCAPE = re.compile(r"\x1b\[([0-9;?]*)([a-zA-Z])")
CALLS = (["plan", "campaign=controllers"], ["explain", "flor"], ["explain", "floor"], ["run", "campaign=nosuch"])


def written(words: list[str], columns: int, folder: Path, **terminal: str) -> str:
    """Return what a call writes to a terminal, with its colours and moves."""
    ours, theirs = pty.openpty()
    surroundings = {**os.environ, "COLUMNS": str(columns), "TERM": "xterm", "PYTHONWARNINGS": "ignore", **terminal}
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
    return text.decode().replace("\r\n", "\n")


def shown(words: list[str], columns: int, folder: Path) -> list[str]:
    """Return the lines that a call shows on a terminal."""
    return re.sub(ESCAPE, "", written(words, columns, folder, NO_COLOR="1")).splitlines()


@pytest.mark.parametrize("words", CALLS, ids=" ".join)
def test_no_word_is_cut_at_the_last_column(tmp_path: Path, words: list[str]) -> None:
    lines = shown(words, 72, tmp_path)
    assert lines and "Traceback" not in "".join(lines)
    for line in lines:
        # one word alone may be longer than the terminal is wide
        assert len(line.rstrip()) <= 72 or " " not in line.strip(), line


RUN = ["run", "campaign=controllers", "conditions=ramp_pos__pid", "repetitions=1", "workers=1", "run_dir=one"]


@pytest.mark.parametrize("terminal", [{"NO_COLOR": "1"}, {"TERM": "dumb"}], ids=str)
def test_a_terminal_without_colours_has_none(empty_folder: Path, terminal: dict[str, str]) -> None:
    text = written(RUN, 80, empty_folder, **terminal)
    codes = ESCAPE.findall(text)
    # bold and dim are no colours, and a bar moves the cursor; a dumb terminal does neither
    coloured = [code for code, kind in codes if kind == "m" and re.search(r"(^|;)(3|4|9|10)\d", code)]
    assert not coloured and bool(codes) is (terminal.get("TERM") != "dumb")
    lines = re.sub(ESCAPE, "", text).splitlines()
    assert len(lines) > 8 and max(len(line.rstrip()) for line in lines) <= 80


@pytest.mark.parametrize("number", [1, 20, 300])
def test_a_long_list_of_what_is_allowed_is_that_of_the_nearest(number: int) -> None:
    names = [f"word_{place:03d}" for place in range(number)]
    text = str(unknown("word", "word_000x", names))
    assert "did you mean 'word_000'" in text
    short = len(", ".join(names)) <= LONGEST_LIST
    assert text.count("word_") - 2 == (number if short else 12)
    assert (f"and {number - 12} that are less like it" in text) is not short
