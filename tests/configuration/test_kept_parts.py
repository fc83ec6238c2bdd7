"""Parts of configurations are kept for later calls: the same values, and a damaged or foreign line is nothing."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hjcamp.configuration import shared_parts
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.shared_parts import _Kept
from hjcamp.configuration.variation import Loaded

PART = Loaded(
    {"rig": {"mass": 1.5, "on": True, "none": None, "far": math.inf, "text": "${rig.mass}"}, "n": [1, 2.0]}, {"rig": "a"}
)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setenv("HJCAMP_CACHE", str(tmp_path))
    shared_parts._parts.cache_clear()
    yield tmp_path
    shared_parts._parts.cache_clear()


def test_a_part_comes_back_as_it_was(tmp_path: Path) -> None:
    file = tmp_path / "below" / "parts.jsonl"
    first = _Kept(file)
    first["rig=a",] = PART, frozenset({"rig", "n"})
    again = _Kept(file)
    assert dict(again) == {("rig=a",): (PART, frozenset({"rig", "n"}))}
    assert repr(again["rig=a",][0].config) == repr(PART.config)  # 1 is no 1.0, and the order stays
    _Kept(file)["b",] = PART, frozenset()
    assert list(_Kept(file)) == [("rig=a",), ("b",)]


@pytest.mark.parametrize(
    "line", ["", "{", '[["rig=b"], {"rig"', "[1, 2, 3, 4]", "null", '{"a": 1}', "[[], [], []]", "\x00\x00", "[" * 2000]
)
def test_what_is_no_part_is_passed_over(tmp_path: Path, line: str) -> None:
    file = tmp_path / "parts.jsonl"
    _Kept(file)["rig=a",] = PART, frozenset()
    file.write_text(line + "\n" + file.read_text(encoding="utf-8") + line, encoding="utf-8")
    assert ("rig=a",) in _Kept(file)
    file.write_bytes(b"\xff\xfe")
    assert not _Kept(file)


@pytest.mark.parametrize("config", [{1: "a number as a key"}, {"folder": Path("a")}, {"pair": (1, 2)}])
def test_what_a_file_would_change_is_not_kept(tmp_path: Path, config: dict[str, Any]) -> None:
    file = tmp_path / "parts.jsonl"
    kept = _Kept(file)
    kept["a",] = Loaded(config, {}), frozenset()
    assert kept["a",][0].config == config and not _Kept(file)


def test_where_nothing_can_be_written_parts_are_of_this_call(tmp_path: Path) -> None:
    (tmp_path / "in_the_way").write_text("", encoding="utf-8")
    kept = _Kept(tmp_path / "in_the_way" / "parts.jsonl")
    kept["a",] = PART, frozenset()
    assert kept["a",][0] is PART


def test_a_later_call_composes_the_same(cache: Path) -> None:
    lines = ["controller=pid", "trajectory=sine_0p5hz", "trajectory.amplitude_deg=0.2"]
    first = Composer().compose(lines)
    file = next((cache / "composed").glob("*.jsonl"))
    assert len(file.read_text(encoding="utf-8").splitlines()) >= 3
    shared_parts._parts.cache_clear()
    later = Composer()

    def refuse(overrides: Any) -> Loaded:
        raise AssertionError(f"composed once more: {overrides}")

    later._variations._load = refuse
    again = later.compose(lines)
    assert json.dumps(again.config) == json.dumps(first.config) and again.choices == first.choices
