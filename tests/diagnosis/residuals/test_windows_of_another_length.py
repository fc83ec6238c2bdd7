"""Windows of another length begin the base elsewhere only where they need to."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from test_erring_sensors import measured  # noqa: F401 - a fixture

from hjcamp.diagnosis.calibration.analysis import Known, calibrated
from hjcamp.diagnosis.calibration.multistart import above_noise
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.estimation.gauss_newton import Fitted
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.model.declare.candidate import Candidate


def test_windows_of_another_length_begin_a_base_apart_only_where_it_leads_elsewhere(
    measured: Measured,  # noqa: F811
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun: list[float] = []

    def counted(windows: Windows, start: Candidate, fitted: Fitted, names: list[str]) -> Fitted:
        begun.append(start.base["magnet"])
        return fitted

    monkeypatch.setattr("hjcamp.diagnosis.calibration.analysis.best_begun", counted)
    monkeypatch.setattr("hjcamp.diagnosis.calibration.analysis.above_noise", lambda *given: True)
    known = Known()
    for width in (46, 23):
        calibrated(measured, {}, unknowns=False, width=width, known=known)
    assert len(begun) == 1
    known.base["magnet"] *= 2.5  # as if the first had led elsewhere
    calibrated(measured, {}, unknowns=False, width=23, known=known)
    assert len(begun) == 2


def test_noise_alone_is_seldom_above_noise() -> None:
    random = np.random.default_rng(5)
    layout: Any = SimpleNamespace(measured=SimpleNamespace(sensors=[0]), predictions=lambda features: features)
    noise = random.standard_normal((400, 96, 8))
    assert 8 <= sum(above_noise(layout, one) for one in noise) <= 34  # one in twenty, and its chance
    assert all(above_noise(layout, 1.2 * one) for one in noise)
