"""The numbers that decide a verdict are quantiles of a table of rigs with nothing missing, and nothing else."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis import levels
from hjcamp.plants.pump_joint.diagnosis.levels import CHANNELS, LEVEL, chance, gains_a_test, least_gain, margin
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS as SEEN

ROWS = levels._rows()


def test_the_channels_are_those_that_a_verdict_judges() -> None:
    assert SEEN[: len(CHANNELS)] == CHANNELS


def test_the_table_has_two_hundred_rigs_and_four_contacts() -> None:
    assert len(ROWS) >= 200 and len({row["seed"] for row in ROWS}) == len(ROWS)
    contacts = Counter(row["contact"] for row in ROWS)
    assert set(contacts) == {"asperities", "bristles", "smooth", "sharp"} and min(contacts.values()) >= 30


def test_one_rig_in_forty_gains_more_than_is_asked_and_one_in_forty_leaves_more_than_is_allowed() -> None:
    tests = np.array([int(row["tests"]) for row in ROWS])
    gains = np.array([float(row["gain"]) for row in ROWS])
    assert np.mean(gains >= [least_gain(count) for count in tests]) == pytest.approx(LEVEL, abs=0.005)
    over = np.array([max(float(row[name]) for name in CHANNELS) for row in ROWS])
    assert np.mean(over > margin()) == pytest.approx(LEVEL, abs=0.005)


def test_chance_falls_with_the_gain_a_test_and_is_never_nought() -> None:
    rigs = len(gains_a_test())
    asked = [chance(gain, 24) for gain in (0.0, 2.0, 5.0, least_gain(24), 1e9)]
    assert asked == sorted(asked, reverse=True) and asked[0] == 1.0 and asked[-1] == 1.0 / (rigs + 1)
    assert chance(least_gain(24), 24) == pytest.approx(LEVEL, abs=0.01)
    assert chance(10.0, 48) == chance(5.0, 24) and least_gain(48) == 2.0 * least_gain(24)


def test_the_numbers_are_read_from_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    head = ",".join(["tests", "gain", *CHANNELS])
    lines = [",".join(["10", str(place), *["1.0"] * 4, str(1.0 + 0.01 * place)]) for place in range(41)]
    path = tmp_path / "nulls.csv"
    path.write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")
    caches = levels._rows, levels.gains_a_test, levels.margin
    monkeypatch.setattr(levels, "TABLE", path)
    try:
        for cache in caches:
            cache.cache_clear()
        assert least_gain(10) == pytest.approx(39.0) and margin() == pytest.approx(1.39)
        assert chance(39.0, 10) == pytest.approx(3 / 42)
    finally:
        for cache in caches:
            cache.cache_clear()
