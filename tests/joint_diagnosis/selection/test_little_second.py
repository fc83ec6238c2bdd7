"""A further effect that gains little, or is one of several, is left out, where the certain first one leaves what its law may leave."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis import diagnose
from hjcamp.plants.pump_joint.diagnosis.diagnose import _Search
from hjcamp.plants.pump_joint.diagnosis.screening.screening import Step

LEAST, SECOND = 10.0, 16.0


def fit(**effects: dict[str, float]) -> Any:
    return SimpleNamespace(candidate=Candidate({}, effects), mean_square=np.ones((3, 7)))


BASE, FIRST = fit(), fit(leakage={})


def step(about: Any, gain: float, **weights: float) -> Step:
    screening = SimpleNamespace(about=about)
    fits = dict.fromkeys(weights)
    return cast(Any, SimpleNamespace(screening=screening, gain=gain, weights=weights, best=next(iter(weights)), fits=fits))


def search() -> Any:
    found: Any = _Search.__new__(_Search)
    found.effects, found.least_gain, found.second_gain = (), lambda name: LEAST, SECOND
    found.work = SimpleNamespace(forward=2)
    return found


def leaving(left: float) -> Any:
    """Return what twins say of a model that leaves ``left`` times what is allowed."""
    return SimpleNamespace(excess=lambda *_: np.full(5, left))


SURE, DOUBT = {"leakage": 1.0}, {"tubing_creep": 0.5, "friction_drift": 0.5}


@pytest.mark.parametrize(
    ("left", "gain", "first", "second", "needless"),
    [
        (0.9, 1.2 * LEAST, SURE, DOUBT, True),
        (1.1, 1.2 * LEAST, SURE, DOUBT, False),
        (0.9, SECOND, SURE, {"tubing_creep": 1.0}, False),
        (0.9, SECOND, SURE, DOUBT, True),
        (1.1, SECOND, SURE, DOUBT, False),
        (0.9, 1.2 * LEAST, SURE, {"tubing_creep": 1.0}, True),
        (0.9, 1.2 * LEAST, {"leakage": 0.5, "entrained_air": 0.5}, DOUBT, False),
    ],
    ids=[
        "left out",
        "the first leaves too much",
        "it gains much",
        "it gains much, but is one of several",
        "one of several is needed",
        "left out though certain",
        "the first is doubtful",
    ],
)
def test_what_is_left_out(left: float, gain: float, first: dict[str, float], second: dict[str, float], needless: bool) -> None:
    one, before, further = search(), step(BASE, 80.0, **first), step(FIRST, gain, **second)
    one.steps = [before, further]
    assert one._needless(further, BASE, FIRST, [before], leaving(left)) is needless


def test_a_single_effect_stays() -> None:
    one, only = search(), step(BASE, 1.2 * LEAST, **DOUBT)
    one.steps = [only]
    assert not one._needless(only, BASE, BASE, [], leaving(0.9))


@pytest.mark.parametrize(
    ("first", "seen", "promised", "looks"),
    [
        (SURE, 30.0, 0.9 * SECOND, False),
        (SURE, 30.0, 1.1 * SECOND, True),
        (SURE, 9.0, 1.1 * SECOND, False),
        ({"leakage": 0.5, "entrained_air": 0.5}, 30.0, 0.9 * SECOND, True),
    ],
    ids=["too little to stay", "enough to stay", "it never promised enough", "the first is doubtful"],
)
def test_a_hasty_search_does_not_look_for_what_would_be_left_out(
    first: dict[str, float], seen: float, promised: float, looks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    promises = SimpleNamespace(gains={"tubing_creep": 0.5 * (promised - 1.0)})
    monkeypatch.setattr(diagnose, "screen", lambda *_: promises)
    about: Any = SimpleNamespace(about=SimpleNamespace(loss=200.0), gains={"leakage": 140.0, "tubing_creep": seen})
    one, best = search(), fit(leakage={})
    best.loss = 50.0
    behind = fit(tubing_creep={})
    behind.loss = 195.0  # a start that is not fitted gains less than it promises
    taken = Step(about, {"leakage": best, "tubing_creep": behind}, first, 0.01, np.zeros(1))
    one.fitter, one.effects = None, tuple(load_effects().values())
    assert one._others([taken], best) is looks
