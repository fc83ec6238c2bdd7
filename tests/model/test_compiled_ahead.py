"""What another process compiles ahead is what this one would compile, and is not compiled here again."""

from __future__ import annotations

import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from wheel_plant import WHEEL

from hjcamp.known_plants import find_plant
from hjcamp.model.compile import compiled_ahead
from hjcamp.model.compile.compose import Composition
from hjcamp.model.compile.kernel_cache import is_compiled
from hjcamp.model.declare.course import Given
from hjcamp.model.run.simulator import Simulator


def test_a_kernel_that_is_compiled_ahead_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # a text of its own: no other test has compiled it in this process
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HJCAMP_CACHE", str(tmp_path / "cache"))
    (tmp_path / "plants").mkdir()
    (tmp_path / "plants" / "wheel.py").write_text(
        WHEEL.replace("parameter.gain *", "0.987 * parameter.gain *"), encoding="utf-8"
    )
    wheel = Simulator(Composition(find_plant("wheel")), free=True)
    assert not is_compiled(wheel.source, "run_free")
    monkeypatch.setattr(compiled_ahead, "_running", [])
    compiled_ahead.compile_ahead([wheel.source])
    [other] = compiled_ahead._running
    try:
        for _ in range(600):
            if is_compiled(wheel.source, "run_free"):
                break
            time.sleep(0.1)
        inputs = np.tile(wheel.inputs(), (4, 1))[:, : len(wheel.composition.inputs)]
        starts = np.ones((1, len(wheel.states)))
        given = Given(2e-3, np.array([1, 0, 0, 0]), 2e-3 * np.arange(4.0), np.ascontiguousarray(inputs), starts)
        ran = wheel.run_to_ends(wheel.vector({}), given)
        assert np.all(np.isfinite(ran.readings)) and ran.readings[0] == 1.0 > ran.readings[3] > 0.0
        hits, misses = wheel.kernel.run_free.stats.cache_hits, wheel.kernel.run_free.stats.cache_misses
        assert sum(hits.values()) == 1 and not misses
        # what is there is asked of nobody
        compiled_ahead.compile_ahead([wheel.source])
    finally:
        assert other.stdin is not None
        other.stdin.close()
        assert other.wait(20.0) == 0


def test_a_folder_that_takes_nothing_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(source: str) -> Path:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(compiled_ahead.kernel_cache, "written_file", refused)
    monkeypatch.setattr(compiled_ahead.kernel_cache, "is_compiled", lambda source, last: False)
    monkeypatch.setattr(compiled_ahead, "_asked", [])
    monkeypatch.setattr(compiled_ahead, "_running", [])
    compiled_ahead.compile_ahead(["text"])
    assert not compiled_ahead._running


def test_kernels_are_given_to_processes_in_turns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[list[str]] = []

    def started() -> SimpleNamespace:
        lines: list[str] = []
        given.append(lines)
        into = SimpleNamespace(write=lambda line: lines.append(line.decode().strip()), flush=lambda: None)
        return SimpleNamespace(stdin=into, poll=lambda: None)

    monkeypatch.setattr(compiled_ahead.kernel_cache, "written_file", lambda source: tmp_path / source)
    monkeypatch.setattr(compiled_ahead.kernel_cache, "is_compiled", lambda source, last: source == "there")
    monkeypatch.setattr(compiled_ahead, "_asked", [])
    monkeypatch.setattr(compiled_ahead, "_running", [])
    monkeypatch.setattr(compiled_ahead, "_started", started)
    compiled_ahead.compile_ahead(["a", "b", "there", "c"])
    compiled_ahead.compile_ahead(["c", "d", "a"])
    assert sorted(map(len, given)) == [2, 2] and sorted(one[-1] for each in given for one in each) == ["a", "b", "c", "d"]
