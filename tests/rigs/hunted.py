"""A hunt whose diagnoses are said by a script: all else, runs, budget, state, page, is the program's."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from answer_schemas import check_answer
from lab_of_rigs import MOTION

from hjcamp import cli
from hjcamp.analyses.data import Data
from hjcamp.commands.hunting.chosen import Choose, Chosen, condition_name
from hjcamp.records.read import read_log

#: Two tests of 0.4 s.
CALL = (*MOTION, "repetitions=2", "workers=1")
BASE = {"mass": {"published": 95.0, "value": 96.0, "unit": "kg", "ci95": [95.0, 97.0]}}


def said(verdict: str, *effects: str, p: float | None = 0.01, error: float = 1.05) -> dict[str, Any]:
    """Return the public part of a diagnosis that a hunt looks at."""
    return {
        "verdict": verdict, "effects": list(effects), "p_value": p, "error": {"baseline": 9.0, "augmented": error},
        "confidence_set": [[one] for one in effects], "calibration": BASE,
    }  # fmt: skip


class Script:
    """Says one diagnosis after the other, the last one for ever; each choice is ``tests`` further motions of 0.4 s, or none."""

    def __init__(self, *diagnoses: Mapping[str, Any], tests: int = 1) -> None:
        self.diagnoses, self.tests = diagnoses, tests
        self.seen: list[list[str]] = []

    def judged(self, data: Data, asked: Any, report: Any) -> tuple[dict[str, Any], Choose]:
        """Return the diagnosis that is due by how many runs there are."""
        self.seen.append(sorted({log.metadata["condition"] for log in data.logs}))
        number = len(data.paths) - 1
        return dict(self.diagnoses[min(number, len(self.diagnoses) - 1)]), self.choose

    def choose(self, configs: Sequence[Mapping[str, Any]], tests: int, number: int, report: Any) -> Chosen:
        """Return motions of other sizes."""
        found, texts = {}, {}
        for place in range(min(self.tests, tests)):
            name = condition_name(f"larger {place}", number, found)
            trajectory = {**configs[0]["trajectory"], "amplitude_m": 0.006 + 0.001 * place}
            found[name], texts[name] = {**configs[0], "trajectory": trajectory}, f"a larger motion, {place}"
        return Chosen({"together": []}, found, texts, 2, ("spring",), "" if found else "all tests leave a limit")


def hunt(*words: str, budget: str = "1min") -> int:
    """Call the command; return its code."""
    return cli.run(["hunt", *CALL, "--budget", budget, *words])


def hunted(folder: str | Path = "out") -> dict[str, Any]:
    """Return what a folder says of its hunt, held against the schema."""
    found = json.loads((Path(folder) / "hunt.json").read_text())
    check_answer(found)
    return dict(found)


def course(found: Mapping[str, Any]) -> list[Any]:
    """Return what decides the course of a hunt."""
    keys = ("run", "tests", "seconds", "made", "diagnosis", "since")
    return [found["state"], found["reason"], *([one[key] for key in keys] for one in found["rounds"])]


def contents(folder: str | Path) -> dict[str, str]:
    """Return the hash of the samples of each log below a folder; their metadata name the commit, which may change meanwhile."""
    found = {}
    for path in sorted(Path(folder).rglob("*.mcap")):
        digest = hashlib.sha256()
        for name, values in sorted(read_log(path).columns.items()):
            digest.update(name.encode() + values.tobytes())
        found[path.relative_to(folder).as_posix()] = digest.hexdigest()
    return found
