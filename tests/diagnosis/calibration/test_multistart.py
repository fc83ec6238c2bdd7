"""A base begins from further places on some of the windows, and goes on on all of them where that is better."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from carriage import COULOMB, MASS, VISCOUS, measured_log

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.calibration.multistart import best_begun
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.estimation.gauss_newton import fit
from hjcamp.model.run.simulator import Ran, Simulator

BASE = {"mass": MASS, "coulomb": COULOMB, "viscous": VISCOUS}


@pytest.fixture
def analysis(axis: Path) -> Analysis:
    return calibrated(measured_tests([measured_log()]), {}, unknowns=False)


@pytest.mark.parametrize("every", [2, 4])
def test_some_runs_of_windows_have_the_features_of_these_windows(
    analysis: Analysis, monkeypatch: pytest.MonkeyPatch, every: int
) -> None:
    monkeypatch.setattr("hjcamp.diagnosis.residuals.windows.WINDOWS", 111 // every)
    windows, model = analysis.windows, analysis.base.fitted.candidate
    windows.balances = None
    some = windows.some()
    rows = some.layout.looked_at[windows.layout.looked_at]
    assert 0.8 / every < rows.mean() < 1.5 / every and some.layout.goes_on.any()
    whole = windows.move_starts(model)
    assert np.allclose(some.move_starts(model), whole[rows], atol=1e-6)
    assert np.array_equal(some.starts, windows.starts[rows])


@pytest.mark.parametrize(("poor", "better"), [("viscous", True), ("mass", True), ("", False)])
def test_starts_that_are_better_on_some_of_the_windows_alone_are_fitted_to_all(
    analysis: Analysis, monkeypatch: pytest.MonkeyPatch, poor: str, better: bool
) -> None:
    monkeypatch.setattr("hjcamp.diagnosis.residuals.windows.WINDOWS", 27)
    windows, found = analysis.windows, analysis.base.fitted
    windows.balances = None
    begun = found.candidate.with_base({poor: 4.0 * found.candidate.base[poor]}) if poor else found.candidate
    windows.move_starts(begun)
    before = fit(windows, begun, found.free, rounds=0)
    samples: list[int] = []
    run = Simulator.run_to_ends

    def counted(self: Simulator, p: object, given: object, *more: object, **options: object) -> Ran:
        samples.append(len(given.time))  # type: ignore[attr-defined]
        return run(self, p, given, *more, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(Simulator, "run_to_ends", counted)
    best = best_begun(windows, begun, before, list(BASE))
    assert (best is not before) == better
    for name, true in BASE.items():
        assert best.candidate.base[name] == pytest.approx(true, rel=0.02), name
    whole = sum(one == len(windows.layout.time) for one in samples)
    # one look at what is stiff, unless something is fitted to all
    assert (whole > 20) == better and len(samples) > 100


@pytest.mark.parametrize("few", [27, 111])
def test_starts_are_fitted_to_the_end_where_they_fit_some_of_the_windows_best(
    analysis: Analysis, monkeypatch: pytest.MonkeyPatch, few: int
) -> None:
    monkeypatch.setattr("hjcamp.diagnosis.residuals.windows.WINDOWS", few)
    search, base = analysis.search, analysis.base.fitted
    starts = [base.candidate.with_base({name: factor * base.candidate.base[name]}) for name in BASE for factor in (0.7, 1.5)]
    ends: list[int] = []
    to_the_end = search.settled
    monkeypatch.setattr(search, "settled", lambda *given: ends.append(1) or to_the_end(*given))
    best = search.best_of(starts, base, to_the_end=True)
    assert best.loss < base.loss + 1.0
    # of six starts two, and the best without delays
    assert len(ends) == (3 if few < 111 else 7)
