"""Of the effects that a screening ranks, only those are fitted that may still turn out best."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from hjcamp.plants.pump_joint.diagnosis.levels import CERTAIN
from hjcamp.plants.pump_joint.diagnosis.selection import step as step_fits
from hjcamp.plants.pump_joint.diagnosis.selection.step import PAIR, StepFitter

PREDICTED = {"leakage": 90.0, "tubing_creep": 42.0, "friction_drift": 40.0, "encoder_lag": 5.0}


@pytest.mark.parametrize(
    ("reached", "enough", "fitted"),
    [
        ({"leakage": 95.0}, 10.0, [["leakage"]]),
        (
            {"leakage": 20.0, "tubing_creep": 30.0, "friction_drift": 10.0},
            10.0,
            [["leakage"], ["tubing_creep", "friction_drift"]],
        ),
        ({"leakage": 2.0, "tubing_creep": 3.0}, 500.0, [["leakage", "tubing_creep"]]),
    ],
    ids=["all others are far behind", "the best falls short of its prediction", "none can reach what is asked"],
)
def test_what_is_fitted(reached: dict[str, float], enough: float, fitted: list[list[str]]) -> None:
    screening: Any = SimpleNamespace(about=SimpleNamespace(loss=200.0), gains=PREDICTED)
    fitting: Any = StepFitter.__new__(StepFitter)
    together: list[list[str]] = []

    def fit(_: Any, names: list[str], fits: dict[str, Any], share: float) -> None:
        together.append(names)
        fits.update({name: SimpleNamespace(loss=200.0 - reached[name]) for name in names})

    fitting._fit = fit
    found = fitting._survivors(screening, list(PREDICTED), 0.0, dict.fromkeys(PREDICTED, enough))
    assert together == fitted
    assert list(found) == [name for names in fitted for name in names]


@pytest.mark.parametrize("hasty", [True, False])
def test_nothing_is_fitted_where_no_fit_could_count(hasty: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    about = SimpleNamespace(loss=200.0)
    screening: Any = SimpleNamespace(about=about, gains=PREDICTED, ranked=PREDICTED)
    null: Any = SimpleNamespace(needed=lambda: 3.0, p_value=lambda gain: 0.01, gains=[])
    fitting: Any = StepFitter.__new__(StepFitter)
    fitting.work, fitting.least_gain = SimpleNamespace(hasty=hasty, survivors=4), lambda name: 2.0 * PREDICTED["leakage"] + 1.1
    fitting.fitter, fitting.effects = SimpleNamespace(least=None), ()
    predicted: list[str] = []

    def predict(_: Any, names: list[str]) -> dict[str, Any]:
        predicted.extend(names)
        return {name: SimpleNamespace(loss=200.0 - PREDICTED[name]) for name in names}

    fitting._fit, fitting._predicted = None, predict
    monkeypatch.setattr(step_fits, "rival_weights", lambda fits, *given: dict.fromkeys(fits, 0.5))
    step = fitting.step(screening, null, 0)
    assert predicted == list(PREDICTED)[:PAIR] == list(step.fits)
    assert step.p_value == CERTAIN, "what could not count is never certain"
