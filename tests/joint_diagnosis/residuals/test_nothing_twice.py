"""A diagnosis looks at each candidate once, and its answer takes what the diagnosis has computed already."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
from hjcamp.plants.pump_joint.diagnosis.answer import Judging, answer
from hjcamp.plants.pump_joint.diagnosis.diagnose import Diagnosis, diagnose
from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import Local
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.diagnosis.scale import scale_of
from hjcamp.plants.pump_joint.diagnosis.screening.screening import unknowns_of

EFFORT = "quick"
LIBRARY = ("leakage", "pressure_offset", "stribeck_friction")
# What a pattern search or a fit comes back to now and then.
FEW = 0.05


@pytest.fixture(scope="module")
def looked(leak: Path) -> Any:
    """A diagnosis, its judging and its answer, and how often each residual was computed before and in the answer."""
    everything = load_effects([])
    effects = tuple(everything[name] for name in LIBRARY)
    evidence = evidence_of([leak])
    counts: Counter[Any] = Counter()
    plain = Views.residuals

    def counted(self: Views, candidate: Candidate, windows: bool = True) -> Any:
        if self.evidence is evidence:
            counts[candidate.key, windows] += 1
        return plain(self, candidate, windows)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Views, "residuals", counted)
        found = diagnose(evidence, effects, effort=EFFORT)
        before = counts.copy()
        judging = Judging(found, effects, EFFORT)
        content = answer(found, effects, EFFORT, 0.0, judging=judging)
    assert content["verdict"] == "effect" and content["effects"] == ["leakage"]
    return found, effects, judging, before, counts


def test_hardly_any_residual_is_computed_twice(looked: Any) -> None:
    *_, before, after = looked
    assert sum(before.values()) > 100
    assert sum(before.values()) - len(before) <= FEW * len(before)
    again = sum(after[key] - before[key] for key in before)
    assert again <= 2, "the answer looked again at what the diagnosis has seen"


def test_the_scale_is_that_of_the_published_model_calibrated_anew(looked: Any) -> None:
    found, _, judging, *_ = looked
    views = found.fitter.views
    alone = scale_of(Views(views.evidence, views.effects))
    assert dict(alone.noise_floors) == dict(judging.scale.noise_floors)
    assert np.array_equal(alone.features, judging.scale.features)


def test_the_answer_has_the_derivatives_of_the_screening(looked: Any) -> None:
    found, effects, judging, *_ = looked
    assert isinstance(found, Diagnosis)
    for local, fit in ((judging.base, found.baseline), (judging.best, found.final)):
        assert local.known is not None and local.fit is fit
        anew = Local(found.fitter, fit, unknowns_of(fit.candidate, effects))
        assert np.array_equal(anew.jacobian, local.jacobian)


def test_a_refit_without_some_tests_is_made_once(looked: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    _, _, judging, *_ = looked
    first = judging.best.without(judging.parts)
    monkeypatch.setattr(Views, "residuals", None)
    assert judging.best.without(judging.parts) == first
    assert judging.best.refitted(judging.parts[0].train).candidate == first[0]
