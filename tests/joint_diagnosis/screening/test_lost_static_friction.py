"""An effect that the base has swallowed is looked for beside the published shape of friction, too."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.screening import screening as search
from hjcamp.plants.pump_joint.diagnosis.screening.screening import Screening, screen, with_static_friction

LOST = Candidate({"coulomb_positive": 5.0, "static_positive": 5.0, "coulomb_negative": 2.0, "static_negative": 2.8})


def test_static_friction_comes_back_in_the_direction_that_has_lost_it() -> None:
    shaped = with_static_friction(LOST)
    assert shaped is not None
    assert shaped.base["static_positive"] == pytest.approx(5.0 * 7.20 / 5.27)
    assert {name: value for name, value in shaped.base.items() if name != "static_positive"} == {
        name: value for name, value in LOST.base.items() if name != "static_positive"
    }
    assert with_static_friction(shaped) is None
    assert with_static_friction(Candidate({})) is None


def screened(loss: float, gains: dict[str, float]) -> Any:
    about = SimpleNamespace(candidate=LOST if loss == 100.0 else with_static_friction(LOST), loss=loss)
    return Screening(about, None, [], None, None, gains, [], {name: [] for name in gains})  # type: ignore[arg-type]


def test_an_effect_is_taken_from_the_shape_beside_which_it_promises_more(monkeypatch: pytest.MonkeyPatch) -> None:
    here = screened(100.0, {"dither_relief": 4.0, "leakage": 30.0})
    there = screened(112.0, {"dither_relief": 20.0, "leakage": 31.0})
    monkeypatch.setattr(search, "_screen_about", lambda fitter, about, *rest: here if about.loss == 100.0 else there)
    fitter: Any = SimpleNamespace(fit=lambda candidate, unknowns, steps: there.about)
    found = screen(fitter, here.about, ())
    # of twice its prediction, the other shape makes up the 12 that it is behind
    assert found.gains == {"dither_relief": pytest.approx(14.0), "leakage": 30.0}
    assert found.instead == {"dither_relief": there}
    assert found.about is here.about
