"""What repetitions differ by can be explained by no model: shares are of what lies above that."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.calibration.shares import left_above, left_of, share_of
from hjcamp.diagnosis.data.repeatability import NoiseFloor, repeatability_of
from hjcamp.diagnosis.levels import DELTA, LEVEL
from hjcamp.diagnosis.validation.channels import Channels

WINDOWS, SIZE, TESTS = 60, 3, 3


def repeated_tests(scatter: float, shared: float, seed: int) -> tuple[Any, np.ndarray, np.ndarray]:
    """The layout of three repetitions of a test, and features: ``scatter`` of each and what they share, and that alone."""
    generator = np.random.default_rng(seed)
    of_test = np.repeat(np.arange(TESTS), WINDOWS)
    common = shared * np.tile(generator.standard_normal((WINDOWS, SIZE)), (TESTS, 1))
    measured = SimpleNamespace(sensors=("one",), conditions={"a": list(range(TESTS))}, noise=np.ones(1))
    layout = SimpleNamespace(measured=measured, of_test=of_test, width=SIZE, predictions=lambda features: features)
    return layout, common + scatter * generator.standard_normal(common.shape), common


def channels_of(layout: Any, features: np.ndarray) -> Channels:
    return Channels(("one",), (slice(0, SIZE),), repeatability_of(layout, features, [slice(0, SIZE)]))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("scatter", [1.0, 10.0, 50.0])
@pytest.mark.parametrize("excess", [1.0, 5.0])
def test_a_law_that_takes_what_repetitions_share_explains_all_however_much_they_scatter(
    scatter: float, excess: float, seed: int
) -> None:
    layout, features, common = repeated_tests(scatter, excess * scatter, seed)
    channels = channels_of(layout, features)
    assert np.sqrt(channels.repeatability.squares[0]) == pytest.approx(scatter, rel=0.15)
    assert channels.share(features - common, features, features) > 0.7
    noise_floor = NoiseFloor("repetitions", np.diag(np.full(SIZE, channels.repeatability.squares[0] + 1.0)))
    windows = SimpleNamespace(layout=layout)
    analysis: Any = SimpleNamespace(windows=windows, channels=channels, noise_floor=noise_floor, measured=layout.measured)
    whole, half, base = (SimpleNamespace(features=features - share * common) for share in (1.0, 0.5, 0.0))
    assert (left_above(analysis, whole, base) or 0.0) < 0.35  # type: ignore[arg-type]
    assert left_above(analysis, half, base) == pytest.approx(0.5, abs=0.2)  # type: ignore[arg-type]


@pytest.mark.parametrize("scatter", [1.0, 10.0, 50.0])
def test_a_steady_gain_of_one_percent_of_the_rms_is_no_share_where_nothing_is_shared(scatter: float) -> None:
    shares = []
    for seed in range(200):
        layout, features, _ = repeated_tests(scatter, 0.0, seed)
        shares.append(channels_of(layout, features).share(0.99 * features, features, features))
    assert np.mean(np.array(shares) >= DELTA) <= LEVEL


def test_without_repetitions_all_of_the_error_counts_and_the_noise_is_unsure() -> None:
    layout, features, _ = repeated_tests(1.0, 1.0, 1)
    layout.measured.conditions = {str(k): [k] for k in range(TESTS)}
    found = channels_of(layout, features)
    assert (found.repeatability.squares[0], found.repeatability.unsure[0]) == (0.0, 1.1)
    assert found.share(0.0 * features, features, features) == pytest.approx(1.0 - 1.1 / np.mean(features**2))


def test_a_row_says_of_what_its_share_is() -> None:
    above = {"left_above_repeatability": 0.1, "heldout_error_ratio": 0.6}
    assert (left_of(above), share_of(above, "sensor")) == (0.1, "the error above the sensor's noise")
    assert share_of(above, "repetitions") == "the error above repeatability"
    # an answer of before has no such key; what lies no higher than repeatability has no share above it
    for row in ({"heldout_error_ratio": 0.6}, {"heldout_error_ratio": 0.6, "left_above_repeatability": None}, {"left": 0.6}):
        assert (left_of(row), share_of(row, "repetitions")) == (0.6, "the error")
