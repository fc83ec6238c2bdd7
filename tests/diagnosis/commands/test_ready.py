"""Whether tests can decide, before any verdict: every spoilt set is named, a sound one has no remark."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import slab as heated
from jsonschema import validate

from hjcamp.cli import run
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

Columns = dict[str, np.ndarray]
SCHEMA = json.loads((Path(__file__).parents[3] / "docs" / "schemas" / "hjcamp.ready-1.json").read_text())


def columns_of(condition: int, repetition: int) -> Columns:
    generator = np.random.default_rng([condition, repetition])
    power = np.repeat(np.random.default_rng(condition).uniform(0.0, 80.0, 30), 100)
    warmth = heated.course(2.5, (25.0, 3.0)[condition], power)
    warmth += heated.NOISE * generator.standard_normal(len(power))
    return {"time_s": np.arange(float(len(power))), "warmth_k": warmth, "power_w": power}


def written(
    spoil: Callable[[Columns, int, int], object] = lambda columns, condition, repetition: None, repetitions: int = 2
) -> None:
    Path("plants").mkdir(exist_ok=True)
    Path("plants/slab.py").write_text(heated.PLANT)
    for condition in range(2):
        for repetition in range(repetitions):
            columns = columns_of(condition, repetition)
            spoil(columns, condition, repetition)
            path = Path(f"logs/{condition}_{repetition}.mcap")
            path.parent.mkdir(exist_ok=True)
            write_log(path, TestLog(columns, {"plant": "slab", "period_s": "1.0", "condition": str(condition)}, {}, path))


def asked() -> tuple[int, dict]:
    code = run(["ready", "logs", "--json", "ready.json"])
    answer = json.loads(Path("ready.json").read_text())
    validate(answer, SCHEMA)
    return code, answer


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_sound_set_has_no_remark_and_says_what_it_would_show() -> None:
    written()
    code, answer = asked()
    assert answer["remarks"] == [] and answer["ready"] and code == 0
    rows = {row["effect"]: row for row in answer["smallest"]}
    assert len(rows) > 3 and any(
        row["amplitude"] is not None and 0.0 < row["amplitude"] < row["usual"] for row in rows.values()
    )


def first_only(change: Callable[[Columns], object]) -> Callable[[Columns, int, int], object]:
    return lambda columns, condition, repetition: change(columns) if (condition, repetition) == (0, 0) else None


def every(change: Callable[[Columns], object]) -> Callable[[Columns, int, int], object]:
    return lambda columns, condition, repetition: change(columns)


def put(name: str, make: Callable[[np.ndarray], np.ndarray]) -> Callable[[Columns], object]:
    return lambda columns: columns.update({name: make(columns[name])})


def jump(time: np.ndarray) -> np.ndarray:
    return time + 40.0 * (np.arange(len(time)) > 1500)


def spike(values: np.ndarray) -> np.ndarray:
    return values + 60.0 * (np.arange(len(values)) == 700)


SPOILT: dict[str, tuple[Callable[[Columns, int, int], object], int, str]] = {
    "a gap": (first_only(put("time_s", jump)), 2, "data"),
    "an uneven clock": (first_only(put("time_s", lambda time: time + 0.1 * np.sin(1.7 * np.arange(len(time))))), 2, "clock"),
    "a spike": (first_only(put("warmth_k", spike)), 2, "columns"),
    "a sensor at its end": (every(put("warmth_k", lambda values: np.minimum(values, 22.0))), 2, "saturation"),
    "a coarse sensor": (every(put("warmth_k", lambda values: 4.0 * np.round(values / 4.0))), 2, "quantisation"),
    "no repetition": (every(lambda columns: None), 1, "repetitions"),
    "one frequency": (
        every(put("power_w", lambda power: 40.0 + 20.0 * np.sin(0.02 * np.pi * np.arange(len(power))))), 2, "excitation",
    ),
    "an input that never moves": (every(put("power_w", lambda power: np.full(len(power), 40.0))), 2, "excitation"),
    "a copy": (
        lambda columns, condition, number: columns.update(columns_of(0, 0)) if (condition, number) == (0, 1) else None, 2, "copies",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", SPOILT)
def test_a_spoilt_set_is_named_with_what_follows(case: str, capsys: pytest.CaptureFixture[str]) -> None:
    spoil, repetitions, check = SPOILT[case]
    written(spoil, repetitions)
    code, answer = asked()
    assert code == 1 and not answer["ready"]
    assert check in {one["check"] for one in answer["remarks"]} and all(one["consequence"] for one in answer["remarks"])
    assert "not ready: " in capsys.readouterr().err
