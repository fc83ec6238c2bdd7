"""Windows of another length begin the base elsewhere only where they need to."""

from __future__ import annotations

import pytest
from test_erring_sensors import measured  # noqa: F401 - a fixture

from hjcamp.model.candidate import Candidate
from hjcamp.prediction.fitting.gauss_newton import Fitted
from hjcamp.prediction.measured.tests import Measured
from hjcamp.prediction.residuals.windows import Windows
from hjcamp.prediction.selection.analysis import Known, calibrated


def test_windows_of_another_length_begin_a_base_apart_only_where_it_leads_elsewhere(
    measured: Measured,  # noqa: F811
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun: list[float] = []

    def counted(windows: Windows, start: Candidate, fitted: Fitted, names: list[str]) -> Fitted:
        begun.append(start.base["magnet"])
        return fitted

    monkeypatch.setattr("hjcamp.prediction.selection.analysis.best_begun", counted)
    monkeypatch.setattr("hjcamp.prediction.selection.analysis.above_noise", lambda *given: True)
    known = Known()
    for width in (46, 23):
        calibrated(measured, {}, unknowns=False, width=width, known=known)
    assert len(begun) == 1
    known.base["magnet"] *= 2.5  # as if the first had led elsewhere
    calibrated(measured, {}, unknowns=False, width=23, known=known)
    assert len(begun) == 2
