"""Where a calibrated model fails: the range that holds an error is found, and none where nothing lies above repeatability."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hjcamp.diagnosis.data.repeatability import Repeatability
from hjcamp.diagnosis.results.where_rows import where_rows
from hjcamp.diagnosis.validation.channels import Channels

WINDOWS, WIDTH, ORDERS = 200, 10, 4


def analysis_of(features: np.ndarray, conditions: dict[str, list[int]], position: np.ndarray) -> SimpleNamespace:
    """A layout of one sensor and one state that is balanced, with windows at these positions (windows,), m."""
    sensor = SimpleNamespace(quantity="position", unit="mm", scale=1e3)
    plant = SimpleNamespace(inputs={"voltage": SimpleNamespace(unit="V")})
    measured = SimpleNamespace(sensors=(sensor,), conditions=conditions, plant=plant)
    tests = len([one for places in conditions.values() for one in places])
    layout = SimpleNamespace(
        measured=measured,
        of_test=np.repeat(np.arange(tests), WINDOWS // tests),
        width=WIDTH,
        readings=np.repeat(position, WIDTH)[:, None],
        inputs=np.zeros((WINDOWS * WIDTH, 1)),
    )
    known = Repeatability(np.ones(2), np.full(2, 0.1))
    channels = Channels(("position_mm", "velocity"), (slice(0, ORDERS), slice(ORDERS, 2 * ORDERS)), known)
    windows = SimpleNamespace(layout=layout)
    return SimpleNamespace(channels=channels, base=SimpleNamespace(features=features), windows=windows, measured=measured)


@pytest.mark.parametrize("channel", [0, 1])
def test_the_range_of_a_reading_in_which_a_channel_errs_is_named(channel: int) -> None:
    generator = np.random.default_rng(1)
    position = generator.uniform(0.0, 0.04, WINDOWS)
    features = generator.standard_normal((WINDOWS, 2 * ORDERS))
    far = position > 0.03
    features[far, channel * ORDERS : (channel + 1) * ORDERS] *= 6.0
    [row] = where_rows(analysis_of(features, {"a": [0, 1]}, position))  # type: ignore[arg-type]
    assert row["subsystem"] == ("position", "velocity")[channel] and row["variable"] == ("prediction", "balance")[channel]
    assert row["bin"].startswith("position 2") or row["bin"].startswith("position 3")
    assert row["share"] == pytest.approx(1.0, abs=0.1) and row["z"] > 5.0


def test_a_condition_that_errs_is_named() -> None:
    generator = np.random.default_rng(2)
    features = generator.standard_normal((WINDOWS, 2 * ORDERS))
    features[WINDOWS // 2 :] *= 5.0
    rows = where_rows(analysis_of(features, {"cold": [0], "warm": [1]}, generator.uniform(0.0, 0.04, WINDOWS)))  # type: ignore[arg-type]
    assert {row["bin"] for row in rows} == {"warm"} and sum(row["share"] for row in rows) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("seed", range(20))
def test_nothing_is_named_where_nothing_lies_above_repeatability(seed: int) -> None:
    generator = np.random.default_rng(seed)
    features = generator.standard_normal((WINDOWS, 2 * ORDERS))
    position = generator.uniform(0.0, 0.04, WINDOWS)
    assert where_rows(analysis_of(features, {"a": [0], "b": [1]}, position)) == []  # type: ignore[arg-type]
