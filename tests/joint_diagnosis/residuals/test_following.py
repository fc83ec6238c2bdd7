"""Tests followed in parts by several threads give the same numbers, digit by digit, as one after the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
from hjcamp.plants.pump_joint.diagnosis.models.saved import complete
from hjcamp.plants.pump_joint.diagnosis.residuals.replay_parallel import parts
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.workers.pool import Crew


def test_parts_begin_with_a_test_and_cover_all() -> None:
    restart = np.zeros(100, dtype=np.int64)
    restart[[0, 10, 60, 70]] = 2
    restart[30] = 1
    assert parts(restart, 1) == [0, 100]
    assert parts(restart, 2) == [0, 60, 100]
    assert parts(restart, 3) == [0, 10, 70, 100]
    assert parts(restart[:10], 4) == [0, 10]


@pytest.mark.parametrize("effect", ["leakage", "stribeck_friction", pytest.param("presliding", marks=pytest.mark.study)])
def test_residuals_do_not_depend_on_the_number_of_workers(leak: Path, effect: str) -> None:
    library = load_effects([])
    effects = (library["leakage"], library["pressure_offset"], library["stribeck_friction"])
    effects = effects if library[effect] in effects else (library[effect],)
    evidence = evidence_of([leak])
    candidate = complete(Candidate({}, {effect: library[effect].defaults()}), evidence)
    found = []
    for workers in (1, 2, 5):
        crew = Crew(workers)
        try:
            found.append(Views(evidence, effects, crew).residuals(candidate))
        finally:
            crew.close()
    assert np.array_equal(found[0], found[1])
    assert np.array_equal(found[0], found[2])
    assert np.any(found[0] != 0.0)


@pytest.mark.study
def test_a_model_without_effects_is_followed_alike_by_the_kernel_that_has_none(
    leak: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = load_effects([])
    effects = (library["leakage"], library["pressure_offset"], library["stribeck_friction"])
    evidence = evidence_of([leak])
    bare = complete(Candidate({}), evidence)
    found = Views(evidence, effects).residuals(bare)
    monkeypatch.setattr(Views, "_needed", lambda self, candidate, hardware: self.effects)
    gated = Views(evidence, effects).residuals(bare)
    scale = np.abs(gated).max(axis=0)
    assert np.all(np.abs(found - gated).max(axis=0) <= 1e-6 * scale)
    assert np.all(scale[:4] > 0.0)
