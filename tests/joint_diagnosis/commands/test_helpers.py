"""Processes that help: the same answers in the same order, whoever does the work and whatever becomes of them."""

from __future__ import annotations

import multiprocessing
import os
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
from hjcamp.plants.pump_joint.diagnosis.diagnose import diagnose
from hjcamp.workers.pool import Crew
from hjcamp.workers.processes import Helpers

OWN = '''"""A constant leak."""

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter


class Own(Effect):
    """Water is lost at a constant rate."""

    subsystem = "lines"
    flow = Parameter("m^3/s", 1e-12, (0.0, 1e-9), off=0.0)

    @staticmethod
    def leak1(flow):
        """Lost flow."""
        return flow
'''


def _nothing() -> None: ...


def _where(factor: float, item: int) -> tuple[float, int]:
    time.sleep(5e-3)
    return factor * item, os.getpid()


def _refused(factor: float, item: int) -> float:
    if item == 3:
        raise UsageError("no such test")
    return factor * item


def _fatal(factor: float, item: int) -> float:
    if item == 2 and multiprocessing.parent_process() is not None:
        os._exit(1)
    time.sleep(5e-2)
    return factor * item


@pytest.fixture
def helpers() -> Iterator[Helpers]:
    found = Helpers(2, _nothing)
    try:
        yield found
    finally:
        found.close()


def test_the_work_is_shared_and_comes_in_order(helpers: Helpers) -> None:
    seen: set[int] = set()
    for factor in (0.5, 2.0):
        found = list(helpers.each(_where, factor, range(200)))
        assert [value for value, _ in found] == [factor * item for item in range(200)]
        seen |= {process for _, process in found}
    assert os.getpid() in seen and len(seen) > 1


def test_who_asks_takes_part_in_few_tasks_too(helpers: Helpers) -> None:
    for count in (2, 3, 4):
        processes = [process for _, process in helpers.each(_where, 1.0, range(count))]
        assert processes[0] != os.getpid() and processes[-1] == os.getpid()


def _named(effect: type[Effect], item: int) -> str:
    return f"{effect.name} {item} {multiprocessing.parent_process() is None}"


def _load() -> None:
    load_effects()


def test_an_effect_of_the_users_own_is_known_everywhere(empty_folder: Path) -> None:
    (empty_folder / "effects").mkdir()
    (empty_folder / "effects" / "my_own.py").write_text(OWN)
    found = Helpers(2, _load)
    try:
        list(found.each(_where, 1.0, range(400)))
        answers = list(found.each(_named, load_effects()["my_own"], range(50)))
    finally:
        found.close()
    assert [answer.split()[:2] for answer in answers] == [["my_own", str(item)] for item in range(50)]
    assert any(answer.endswith("False") for answer in answers)


def _broken() -> None:
    os._exit(1)


def test_processes_that_cannot_begin_are_done_without() -> None:
    found = Helpers(1, _broken)
    try:
        list(found.each(_where, 1.0, range(300)))
        assert [process for _, process in found.each(_where, 1.0, range(20))] == [os.getpid()] * 20
    finally:
        found.close()


def test_a_failure_is_told(helpers: Helpers) -> None:
    with pytest.raises(UsageError, match="no such test"):
        list(helpers.each(_refused, 1.0, range(6)))
    assert list(helpers.each(_refused, 1.0, range(3))) == [0.0, 1.0, 2.0]


def test_who_asks_does_what_a_killed_process_has_left(helpers: Helpers) -> None:
    list(helpers.each(_where, 1.0, range(400)))
    assert list(helpers.each(_fatal, 1.0, range(40))) == [float(item) for item in range(40)]
    assert list(helpers.each(_fatal, 2.0, range(3))) == [0.0, 2.0, 4.0]
    assert helpers._pool is None


def test_nothing_is_left_behind() -> None:
    found = Helpers(1, _nothing)
    list(found.each(_where, 1.0, range(4)))
    folder = Path(found._folder.name)
    assert folder.is_dir()
    found.close()
    found.close()
    assert not folder.exists()
    assert list(found.each(_where, 1.0, range(2)))[1][1] == os.getpid()


@pytest.mark.study
def test_a_diagnosis_is_the_same_with_processes(leak: Path) -> None:
    library = load_effects([])
    effects = (library["leakage"], library["pressure_offset"], library["stribeck_friction"])
    evidence = evidence_of([leak])
    found = []
    for crew in (Crew(1), Crew(2, ready=_nothing)):
        try:
            found.append(diagnose(evidence, effects, effort="quick", crew=crew))
        finally:
            crew.close()
    alone, shared = found
    assert (alone.verdict, alone.effects) == (shared.verdict, shared.effects) == ("effect", ["leakage"])
    assert alone.final.candidate == shared.final.candidate and alone.p_value == shared.p_value
    assert np.array_equal(alone.null.gains, shared.null.gains)
