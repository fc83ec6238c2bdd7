"""A rig that hunts in every test has no steady sliding: that channel says nothing, and the others still do."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import JUDGED, judged_error
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS, HOME
from hjcamp.plants.pump_joint.diagnosis.screening.responses import Responses

SLIDING = CHANNELS.index("sliding")


def noise_floor_of(silent: bool) -> np.ndarray:
    noise_floor = np.full(len(CHANNELS), 2.0)
    noise_floor[SLIDING] = 0.0 if silent else 2.0
    return noise_floor


@pytest.mark.parametrize("silent", [True, False])
def test_a_response_is_sized_where_something_is_said(silent: bool) -> None:
    responses = Responses.__new__(Responses)
    responses.noise_floor, responses.spoken = noise_floor_of(silent), np.full(len(CHANNELS), 10)
    response = np.zeros((10, len(CHANNELS)))
    response[:, 0] = 6.0
    assert responses.size(response) == pytest.approx(3.0)
    assert responses.size(np.zeros_like(response)) == 0.0


@pytest.mark.parametrize("told", [True, False])
def test_a_silent_channel_is_no_error_of_zero(told: bool) -> None:
    evidence = SimpleNamespace(homes=np.array([0.0 if told else np.nan] * 2))
    features = SimpleNamespace(counts=np.ones((2, len(CHANNELS))), evidence=evidence)
    mean_square = np.full((2, len(CHANNELS)), 16.0)
    mean_square[:, SLIDING] = 0.0
    assert HOME >= JUDGED
    error = judged_error(features, mean_square, noise_floor_of(True), [0, 1])  # type: ignore[arg-type]
    assert error == pytest.approx(2.0)
