"""What is found of the joint does not hang on the names and order of files and conditions, on copies, workers or hashes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hjcamp
from hjcamp import cli
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import by_repetition
from hjcamp.records.find import read_logs
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

# another order of sums moves a number by 1e-11 of itself when this was written
RELATIVE = 1e-8
# it goes with p among 24 null replicates, whose draws follow the order of the tests: 0.18 against 0.16
POSTERIOR = 0.1
NAMES = {"x/\N{SNOWMAN} ramp_pos__pid": "ramp_pos__pid", "y = 1": "ramp_neg__pid"}


def log_of(condition: str, repetition: str | None) -> TestLog:
    about = {"condition": condition} | ({} if repetition is None else {"repetition": repetition})
    return TestLog({"time_s": np.arange(3.0)}, about)


@pytest.mark.parametrize("order", list(permutations(range(4))))
def test_repetitions_stand_in_the_order_of_their_numbers(order: tuple[int, ...]) -> None:
    logs = [log_of("a", "2"), log_of("b", None), log_of("a", "10"), log_of("b", "1")]
    given = [logs[place] for place in order]
    found = by_repetition(given)
    assert [log.metadata["repetition"] for log in found if log.condition_key == "a"] == ["2", "10"]
    assert [log.condition_key for log in found] == [log.condition_key for log in given]
    assert [id(log) for log in found if log.condition_key == "b"] == [id(log) for log in given if log.condition_key == "b"]


def diagnosed(folder: str, workers: str, hash_seed: str) -> dict[str, Any]:
    """Return the answer of the command in a process of its own, whose texts have the hashes of a seed."""
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1])}
    words = ["diagnose", folder, "--effort", "quick", "--only", "leakage", "--workers", workers, "--json", f"{folder}.json"]
    done = subprocess.run([sys.executable, "-m", "hjcamp", *words], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    text = Path(f"{folder}.json").read_text()
    for new, old in NAMES.items():
        text = text.replace(json.dumps(new), json.dumps(old))
    return dict(json.loads(text))


def nearly(found: Any, usual: Any, where: str = "") -> None:
    """Hold two answers against each other: every text and structure the same, every number next to it."""
    if isinstance(usual, dict):
        assert found.keys() == usual.keys(), where
        for key, value in usual.items():
            nearly(found[key], value, f"{where}.{key}")
    elif isinstance(usual, list):
        assert len(found) == len(usual), where
        for number, value in enumerate(usual):
            nearly(found[number], value, f"{where}[{number}]")
    elif isinstance(usual, float):
        assert found == pytest.approx(usual, rel=RELATIVE, abs=POSTERIOR if where.endswith(".posterior") else 0.0), where
    else:
        assert found == usual, where


@pytest.mark.study
def test_the_answer_of_the_joint_does_not_hang_on_files_conditions_copies_workers_and_hashes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    line = ["campaign=controllers", "conditions=[ramp_pos__pid,ramp_neg__pid]", "repetitions=2", "run_dir=made"]
    assert cli.run(["run", *line]) == 0
    logs = read_logs([Path("made")])
    renamed = {old: new for new, old in NAMES.items()}
    other = [replace(log, metadata={**log.metadata, "condition": renamed[log.metadata["condition"]]}) for log in logs]
    for number, (usual, changed) in enumerate(zip(logs, other, strict=True)):
        write_log(Path("usual") / f"a{number}.mcap", usual)
        write_log(Path("other") / f"z{9 - number}.mcap", changed)
    write_log(Path("other") / "zz.mcap", other[0])
    answers = [diagnosed("usual", "1", "1"), diagnosed("other", "2", "7")]
    for answer in answers:
        answer.pop("seconds")
    nearly(answers[1], answers[0])
