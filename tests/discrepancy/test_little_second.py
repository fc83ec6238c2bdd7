"""A further effect that gains little, or is one of several, is left out, where the certain first one leaves what its law may leave."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.discrepancy import diagnose
from hjcamp.discrepancy.candidate import Candidate
from hjcamp.discrepancy.diagnose import LITTLE, PROMISING, _Search
from hjcamp.discrepancy.search import Step
from hjcamp.effects import load_effects

LEAST = 10.0


def fit(**effects: dict[str, float]) -> Any:
    return SimpleNamespace(candidate=Candidate({}, effects), mean_square=np.ones((3, 7)))


BASE, FIRST, BOTH = fit(), fit(leakage={}), fit(leakage={}, tubing_creep={})


def step(about: Any, gain: float, **weights: float) -> Step:
    screening = SimpleNamespace(about=about)
    fits = dict.fromkeys(weights)
    return cast(
        Any, SimpleNamespace(screening=screening, gain=gain, weights=weights, best=next(iter(weights)), fits=fits)
    )


def search(left: float) -> Any:
    """Return a search in which the model before the second step leaves ``left`` times what is allowed."""
    found: Any = _Search.__new__(_Search)
    found.effects, found.least_gain, found.scatter = (), LEAST, "of the last model"
    found.work = SimpleNamespace(forward=2)

    def look(current: Any, number: int, whole: bool) -> tuple[Any, Any]:
        found.scatter = "of the model before"
        return None, SimpleNamespace(name="null before", excess=lambda *_: np.full(5, left))

    found._look = look
    return found


SURE, DOUBT = {"leakage": 1.0}, {"tubing_creep": 0.5, "friction_drift": 0.5}


@pytest.mark.parametrize(
    ("left", "gain", "first", "second", "kept"),
    [
        (0.9, 1.2 * LEAST, SURE, DOUBT, 1),
        (1.1, 1.2 * LEAST, SURE, DOUBT, 2),
        (0.9, LITTLE * LEAST, SURE, {"tubing_creep": 1.0}, 2),
        (0.9, LITTLE * LEAST, SURE, DOUBT, 1),
        (1.1, LITTLE * LEAST, SURE, DOUBT, 2),
        (0.9, 1.2 * LEAST, SURE, {"tubing_creep": 1.0}, 1),
        (0.9, 1.2 * LEAST, {"leakage": 0.5, "entrained_air": 0.5}, DOUBT, 2),
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
def test_what_stays(left: float, gain: float, first: dict[str, float], second: dict[str, float], kept: int) -> None:
    one = search(left)
    steps = [step(BASE, 80.0, **first), step(FIRST, gain, **second)]
    one.steps = steps
    current, taken, null = one._told(BASE, BOTH, steps, "null of the last")
    assert taken == steps[:kept]
    assert current is (FIRST if kept == 1 else BOTH)
    assert getattr(null, "name", null) == ("null before" if kept == 1 else "null of the last")
    assert one.scatter == ("of the model before" if kept == 1 else "of the last model")


def test_a_single_effect_stays() -> None:
    steps = [step(BASE, 1.2 * LEAST, **DOUBT)]
    assert search(0.9)._told(BASE, FIRST, steps, "null")[:2] == (FIRST, steps)


@pytest.mark.parametrize(
    ("first", "promised", "looks"),
    [(SURE, 17.7, False), (SURE, 1.1 * PROMISING * LEAST, True), ({"leakage": 0.5, "entrained_air": 0.5}, 17.7, True)],
    ids=["too little to stay", "enough to stay", "the first is doubtful"],
)
def test_a_hasty_search_does_not_look_for_what_would_be_left_out(
    first: dict[str, float], promised: float, looks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    promises = SimpleNamespace(gains={"tubing_creep": 0.5 * (promised - 1.0)})
    monkeypatch.setattr(diagnose, "screen", lambda *_: promises)
    one, taken = search(0.9), step(SimpleNamespace(loss=200.0), 150.0, **first)
    taken.fits.clear()
    taken.fits.update(leakage=SimpleNamespace(loss=50.0), tubing_creep=SimpleNamespace(loss=100.0))
    one.fitter, one.effects = None, tuple(load_effects().values())
    assert one._others([taken], fit(leakage={})) is looks
