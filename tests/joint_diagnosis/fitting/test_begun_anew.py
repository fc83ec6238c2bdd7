"""A model that had not come to its optimum is fitted again before a further effect counts: it would gain what was left."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis import diagnose
from hjcamp.plants.pump_joint.diagnosis.diagnose import _Search
from hjcamp.plants.pump_joint.diagnosis.selection.verdict import Verdict

EFFECTS: Any = ()


def fit(loss: float, **effects: dict[str, float]) -> Any:
    return SimpleNamespace(loss=loss, candidate=Candidate({}, effects), features=None, mean_square=np.ones((3, 7)))


def step(about: Any, best: str, after: Any) -> Any:
    gain = about.loss - after.loss
    screening = SimpleNamespace(about=about)
    return SimpleNamespace(screening=screening, best=best, fits={best: after}, gain=gain, p_value=0.01, weights={best: 1.0})


@pytest.fixture
def search(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A search whose fit without the last effect ends at ``refitted``, and which settles to one less."""
    found: Any = _Search.__new__(_Search)
    found.effects, found.features, found.fitter = EFFECTS, None, None
    found.least_gain = lambda name: 10.0
    found.work = SimpleNamespace(steps=4, sweeps=6, forward=2, hasty=False, replicates=24)
    found.refitted = 500.0
    monkeypatch.setattr(diagnose, "unknowns_of", lambda *given: [])
    monkeypatch.setattr(
        diagnose,
        "refit_without",
        lambda fitter, one, name, *rest: fit(found.refitted, **one.candidate.without([name]).effects),
    )
    monkeypatch.setattr(diagnose, "settle", lambda fitter, one, *rest: fit(one.loss - 1.0, **dict(one.candidate.effects)))
    return found


def test_a_model_at_its_optimum_stays_as_it_is(search: Any) -> None:
    current = fit(502.0, position_friction={})
    assert search._begun_anew(step(current, "leakage", fit(465.0, position_friction={}, leakage={}))) is None


def test_a_model_that_had_stuck_is_taken_from_where_the_effect_has_led(search: Any) -> None:
    search.refitted = 470.0
    current = fit(502.0, position_friction={})
    begun = search._begun_anew(step(current, "leakage", fit(465.0, position_friction={}, leakage={})))
    assert begun.loss == 469.0
    assert set(begun.candidate.effects) == {"position_friction"}


def test_what_gained_only_what_a_stuck_base_had_left_is_not_taken(search: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    stuck, looked = fit(502.0), list[float]()
    search.refitted, search.evidence, search.steps, search.nulls = 470.0, None, [], []
    search.views, search.scatter, search.report = None, None, lambda *given: None
    null: Any = SimpleNamespace(needed=lambda: 3.0, gains=np.zeros(24))

    def look(current: Any, number: int, whole: bool, taken: Any = ()) -> tuple[Any, Any]:
        looked.append(current.loss)
        return SimpleNamespace(about=current), null

    search._look = look
    leak = SimpleNamespace(step=lambda screening, *given: step(screening.about, "leakage", fit(465.0, leakage={})))
    monkeypatch.setattr(diagnose, "StepFitter", lambda *given: leak)
    features = SimpleNamespace(noise_floor=lambda found: np.ones(7))
    search.features, search.evidence = features, SimpleNamespace(repeated=True, tests=[None] * 24)
    monkeypatch.setattr(diagnose, "rig_chance", lambda step, tests: 0.2 if tests == 24 else 1.0)
    monkeypatch.setattr(diagnose, "calibrate", lambda *given, **named: (stuck, None))
    monkeypatch.setattr(diagnose, "lacks", lambda evidence: [])
    monkeypatch.setattr(diagnose, "rank_drivers", lambda *given: [])
    monkeypatch.setattr(diagnose, "top_drivers", lambda ranked: [])
    monkeypatch.setattr(diagnose, "detectable_amplitudes", lambda *given: {})
    monkeypatch.setattr(diagnose, "confounded", lambda screening: [])
    monkeypatch.setattr(diagnose, "judge", lambda *given: Verdict("nothing_missing", [], "it is so"))
    found = search.run(None, 0.0)
    assert looked == [501.0, 469.0]
    assert found.baseline.loss == found.final.loss == 469.0
    assert not found.taken and len(found.steps) == 1
    # of the chances by twins and by rigs with other contacts the larger is told
    assert found.p_value == found.rig_chance == 0.2 > found.steps[0].p_value
