"""The study of bad calls judges rightly, reaches every command and every kind of file, and runs."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest
from bad_calls import Outcome
from bad_cases import all_cases, commands
from bad_files import DAMAGES, FILES

import hjcamp
from hjcamp.commands import command_files

STUDY = Path(__file__).with_name("bad_calls.py")


@pytest.mark.parametrize(
    ("outcome", "fault"),
    [
        (Outcome(None, 20.0, "", ""), "did not end"),
        (Outcome(1, 1.0, "", "hjcamp: internal error: KeyError: 'a'"), "internal error"),
        (Outcome(1, 1.0, "", "Traceback (most recent call last):\n"), "internal error"),
        (Outcome(-11, 1.0, "", "x"), "exit code -11"),
        (Outcome(1, 1.0, "", "x", ("a.mcap.part",)), "left a.mcap.part"),
        (Outcome(2, 1.0, "", "x", (), ("tour/about.txt",)), "refused, and wrote tour/about.txt"),
        (Outcome(2, 1.0, "", "x\n" * 13), "a message of many lines"),
        (Outcome(2, 1.0, "said", ""), "no message"),
        (Outcome(0, 1.0, " \n", ""), "code 0 and nothing said"),
    ],
)
def test_what_counts_as_a_fault(outcome: Outcome, fault: str) -> None:
    assert fault in outcome.faults()


@pytest.mark.parametrize("code", [0, 1, 2, 3, 130])
def test_what_does_not(code: int) -> None:
    assert Outcome(code, 1.0, "", "hjcamp: what and where").faults() == []


def test_every_command_option_and_kind_of_file_is_tried() -> None:
    cases = all_cases(random.Random(1), 600)
    assert len(cases) >= 600
    assert {case.words[0] for case in cases} >= set(command_files())
    options = {(name, option) for name, given in commands().items() for option, _ in given}
    tried = {tuple(case.about.split(" --")) for case in cases if " --" in case.about}
    flags = {(name, option) for name, given in commands().items() for option, kind in given if kind == "flag"}
    assert {(name, option[2:]) for name, option in options - flags} <= tried
    assert {case.about for case in cases} >= {f"{name}: {how}" for name in FILES for how in DAMAGES}


@pytest.mark.study
def test_the_study_runs() -> None:
    environment = {**os.environ, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1])}
    words = [sys.executable, str(STUDY), "600", "--only", "'repetitions=0'", "--limit", "100"]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("1 bad calls: 1 with code 2;") and done.stdout.rstrip().endswith("0 faults")
