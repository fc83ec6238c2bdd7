"""Tests that are called alike are repetitions where they follow one course."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from carriage import measured_log

from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.results.channel_rows import _few_windows
from hjcamp.report.wording.repeatability import worst_words


def groups(*logs: object) -> list[list[int]]:
    return list(measured_tests(list(logs)).conditions.values())  # type: ignore[arg-type]


def test_the_same_swing_is_a_repetition_and_another_one_is_not(axis: Path) -> None:
    swings = [measured_log(seconds=4.0, seed=seed, noise=noise) for seed, noise in ((1, 0.0), (1, 1e-6), (2, 0.0))]
    assert groups(*swings) == [[0, 1], [2]]
    names = list(measured_tests(swings).conditions)
    assert len(set(names)) == 2 and all(name.startswith("swing (") for name in names)
    # noise in the log, and in what the loop makes of it, is no other course; nor is a shorter test
    noisy = measured_log(seconds=4.0, seed=1, noise=1e-4)
    noisy.columns["voltage_v"] = noisy.columns["voltage_v"] + 9.0 * np.random.default_rng(3).standard_normal(2000)
    assert groups(measured_log(seconds=4.0, seed=1), measured_log(seconds=4.0, path=lambda t: 0.05 * np.sin(t))) == [[0], [1]]
    assert groups(swings[0], noisy, measured_log(seconds=3.0, seed=1, noise=1e-6)) == [[0, 1, 2]]


def test_other_conditions_stay_apart_and_their_names_as_they_are(axis: Path) -> None:
    noisy = ((name, 1e-6 * k) for k, name in enumerate(("a", "b", "a")))
    found = measured_tests([measured_log(seconds=2.0, condition=name, noise=noise) for name, noise in noisy])
    assert found.conditions == {"a": [0, 2], "b": [1]} and found.twice == ()


def test_what_nothing_drives_is_repeated_where_it_begins_alike(axis: Path) -> None:
    def released(begun: float, decay: float) -> object:
        log = measured_log(seconds=3.0)
        log.columns["voltage_v"][:] = 0.0
        time = log.columns["time_s"]
        log.columns["position_m"][:] = begun * np.exp(-decay * time) * np.cos((4.0 + decay) * time)
        return log

    # other friction makes another swing of the same start
    assert groups(released(0.1, 0.3), released(0.101, 0.8), released(0.07, 0.3)) == [[0, 1], [2]]


def test_one_test_in_two_files_is_looked_at_once(axis: Path) -> None:
    first, other = measured_log(seconds=2.0, condition="a"), measured_log(seconds=2.0, condition="a", noise=1e-6)
    found = measured_tests([first, other, replace(first)])
    assert found.conditions == {"a": [0, 1]} and found.twice == ((first.condition_key, first.condition_key),)


def test_where_half_of_an_error_is_in_few_windows_these_are_told() -> None:
    tests = tuple(SimpleNamespace(name=name) for name in "ab")
    measured, time = SimpleNamespace(sensors=("one",), tests=tests), np.tile(np.arange(60.0), 2)
    layout = SimpleNamespace(measured=measured, of_test=np.repeat([0, 1], 6), width=10, time=time, predictions=lambda one: one)
    features = np.full((12, 4), 0.1)
    features[[4, 7]] = 2.0
    rows = np.arange(12)
    first, second = {"test": "a", "time_s": 40.0}, {"test": "b", "time_s": 10.0}
    assert _few_windows(layout, features, rows, 0) == [first, second]  # type: ignore[arg-type]
    features[4] = 1.0
    assert _few_windows(layout, features, rows, 0) == [second]  # type: ignore[arg-type]
    # as much everywhere is in no few windows
    assert _few_windows(layout, np.ones((12, 4)), rows, 0) == []  # type: ignore[arg-type]
    row = {"condition": "swing", "channel": "position_m", "over_floor": 4.0, "shared": None, "unit": "m"}
    at = [{"test": "b", "time_s": 10.0}]
    assert worst_words([row | {"at": at}], "the noise") == ["swing 4 x the noise in position, half of it about 10 s in b."]
    assert worst_words([row], "the noise") == ["swing 4 x the noise in position."]
