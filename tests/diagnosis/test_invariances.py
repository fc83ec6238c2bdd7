"""What a diagnosis finds does not hang on how a machine and its logs are written down, nor on the processes that search."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from slide import NAMES, OTHER, PLANT, REST, STIFFNESS, measured_log

import hjcamp
from hjcamp.analyses.data import Data
from hjcamp.analyses.diagnosing import Asked, diagnose_plant
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

ONLY = "spring,constant_force"
# another order of sums and of the tests moves a parameter by less: by 1e-5 of the stiffness and 1e-6 m when this was written
RELATIVE, REST_M = 1e-4, 1e-5


def written(folder: Path, plant: str, logs: dict[str, TestLog], monkeypatch: pytest.MonkeyPatch) -> Path:
    """Write a folder with a plant and logs of these names, and work there; return it."""
    (folder / "plants").mkdir(parents=True)
    monkeypatch.chdir(folder)
    (folder / "plants" / "slide.py").write_text(plant, encoding="utf-8")
    for name, log in logs.items():
        write_log(folder / "logs" / f"{name}.mcap", log)
    return folder


def diagnosed() -> dict[str, Any]:
    """Return the answer of a diagnosis by one worker, in this process."""
    return diagnose_plant(Data(["logs"]), Asked(effort="quick", only=ONLY, workers=1)).content


def diagnosed_by_two(hash_seed: str) -> dict[str, Any]:
    """Return the answer of the command by two workers, hashes of texts being those of a seed."""
    environment = {
        **os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1]),
    }  # fmt: skip
    words = ["diagnose", "logs", "--effort", "quick", "--only", ONLY, "--workers", "2", "--json", "answer.json"]
    done = subprocess.run([sys.executable, "-m", "hjcamp", *words], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(Path("answer.json").read_text())
    return answer


def found(content: dict[str, Any]) -> dict[str, float]:
    """Return the parameters of the spring that was found, SI; any other verdict is an error."""
    assert (content["verdict"], content["effects"]) == ("effect", ["spring"])
    row = next(row for row in content["candidates"] if row["effect"] == "spring")
    return {name: one["value"] for name, one in row["parameters"].items()}


def rewritten(log: TestLog, names: dict[str, tuple[str, float]], sign: float = 1.0, **metadata: str) -> TestLog:
    """Return the log with columns of other names, units and signs."""
    columns = {"time_s": log.columns["time_s"]}
    for name, values in log.columns.items():
        if name != "time_s":
            new, scale = names.get(name, (name, 1.0))
            columns[new] = sign * scale * values
    return replace(log, columns=columns, metadata={**log.metadata, **metadata})


def compared(content: dict[str, Any], names: dict[str, str]) -> dict[str, Any]:
    """Return what an answer says of the machine, conditions by the names they had before."""
    own = {key: value for key, value in content.items() if key not in ("twice", "seconds", "made_from")}
    text = json.dumps(own, ensure_ascii=False, sort_keys=True)
    for new, old in names.items():
        text = text.replace(json.dumps(new, ensure_ascii=False), json.dumps(old))
    return dict(json.loads(text))


@pytest.fixture(scope="module")
def logs() -> Sequence[TestLog]:
    return [measured_log(seed) for seed in (1, 2)]


@pytest.fixture(scope="module")
def usual(logs: Sequence[TestLog], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    with pytest.MonkeyPatch.context() as patch:
        written(tmp_path_factory.mktemp("usual") / "slide", PLANT, dict(zip("ab", logs, strict=True)), patch)
        return diagnosed()


def test_what_is_found_is_near_what_is_there(usual: dict[str, Any]) -> None:
    assert found(usual)["stiffness"] == pytest.approx(STIFFNESS, rel=0.03)
    assert found(usual)["rest_position"] == pytest.approx(REST, abs=1e-3)


def test_no_digit_hangs_on_workers_hashes_copies_and_names_of_conditions(
    logs: Sequence[TestLog], usual: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changed = {"a": rewritten(logs[0], {}, condition="x/\N{SNOWMAN}"), "b": logs[1], "once more": logs[0]}
    written(tmp_path / "slide", PLANT, changed, monkeypatch)
    answer = diagnosed_by_two("7")
    assert answer["twice"] == [["logs/once more.mcap", "logs/a.mcap"]]
    assert compared(answer, {"x/\N{SNOWMAN}": "steps 1"}) == compared(usual, {})


@pytest.mark.parametrize(
    ("plant", "names", "sign", "files"),
    [
        pytest.param(PLANT, {}, -1.0, "zy", id="sign, order and names of the logs"),
        pytest.param(OTHER, NAMES, -1.0, "zy", id="all at once", marks=pytest.mark.study),
        pytest.param(OTHER, NAMES, 1.0, "ab", id="names, order and units of the plant", marks=pytest.mark.study),
        pytest.param(PLANT, {}, -1.0, "ab", id="sign", marks=pytest.mark.study),
        pytest.param(PLANT, {}, 1.0, "zy", id="order and names of the logs", marks=pytest.mark.study),
    ],
)
def test_what_is_found_does_not_hang_on_how_it_is_written(
    logs: Sequence[TestLog], usual: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    plant: str, names: dict[str, tuple[str, float]], sign: float, files: str,
) -> None:  # fmt: skip
    changed = [rewritten(log, names, sign) for log in logs]
    written(tmp_path / "slide", plant, dict(zip(files, changed, strict=True)), monkeypatch)
    spring, before = found(diagnosed()), found(usual)
    assert spring["stiffness"] == pytest.approx(before["stiffness"], rel=RELATIVE)
    assert sign * spring["rest_position"] == pytest.approx(before["rest_position"], abs=REST_M)
