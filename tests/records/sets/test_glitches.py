"""Readings that jump out and back, or stay as they were: found where they are, and nowhere else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from log_makers import make_log

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.importing import import_files
from hjcamp.records.glitches import freezes, no_readings, spikes, wraps
from hjcamp.records.plausible import findings
from hjcamp.records.read import read_log

N = 4000


def moving(seed: int, noise: float) -> np.ndarray:
    """Return readings of what swings and drifts, with noise."""
    generator = np.random.default_rng(seed)
    time = np.arange(N) / 200.0
    return np.asarray(60.0 * np.sin(1.3 * time) + 4.0 * np.sin(17.0 * time) + noise * generator.standard_normal(N))


def sound(seed: int) -> dict[str, np.ndarray]:
    """Return readings in which nothing is wrong."""
    generator = np.random.default_rng(seed)
    steps = np.repeat(generator.uniform(-5.0, 5.0, N // 50), 50)
    bang = np.sign(np.sin(np.arange(N) / 3.0))
    kept = np.where(np.arange(N) < 1000, 0.0, 35.0)
    return {
        "white noise": generator.standard_normal(N),
        "noise with long tails": generator.standard_t(4.0, N),
        "a swing": moving(seed, 0.05),
        "steps": steps,
        "noisy steps": steps + 0.1 * generator.standard_normal(N),
        "a few counts": np.round(3.0 * np.sin(np.arange(N) / 300.0)),
        "one count beside another": np.round(0.501 + 1e-3 * generator.standard_normal(N)),
        "a switch": bang,
        "set to another value once": kept,
        "rests and moves": np.concatenate([np.zeros(2000), np.cumsum(np.ones(2000))]),
        "nothing": np.zeros(N),
    }


@pytest.mark.parametrize("seed", range(20))
def test_sound_readings_have_no_glitches(seed: int) -> None:
    for name, values in sound(seed).items():
        assert len(spikes(values)) == 0, name
        assert freezes(values) == [], name
        assert len(wraps(values)) == len(no_readings(values)) == 0, name


@pytest.mark.parametrize("seed", range(5))
def test_single_readings_that_jump_out_and_back_are_found(seed: int) -> None:
    values = moving(seed, 0.05)
    places = np.array([100, 101, 900, 2500, 2501, 2502, 3000])
    values[places] += np.array([30.0, 31.0, -50.0, 40.0, 42.0, 41.0, 25.0])
    assert list(spikes(values)) == list(places)
    assert freezes(values) == []


def test_a_jump_that_stays_is_no_spike_and_hides_none_that_is_larger() -> None:
    values = moving(1, 0.05)
    values[2000:] += 40.0
    assert len(spikes(values)) == 0
    values[500] += 200.0
    assert list(spikes(values)) == [500]


def test_more_than_one_reading_in_a_hundred_is_the_column() -> None:
    values = moving(1, 0.05)
    values[::50] += 100.0
    assert len(spikes(values)) == 0


def test_a_sensor_that_stood_still_is_found() -> None:
    values = moving(2, 0.05)
    values[1500:1580] = values[1500]
    assert freezes(values) == [(1500, 1579)]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "places",
    [
        [0],
        [N - 1],
        [0, 1, 2],
        [N - 2, N - 1],
        [0, 900, 2500],
        [900, 901, 902, 903, 2500],
        [0, 700, 701, N - 1],
        [400, N - 3, N - 2, N - 1],
    ],
)
def test_a_wrong_first_or_last_reading_hides_no_other(seed: int, places: list[int]) -> None:
    values = moving(seed, 0.05)
    values[places] = -9999.0
    assert list(spikes(values)) == places


@pytest.mark.parametrize(
    ("rows", "places"),
    [
        ([(1500, 1579), (2500, 2559)], []),
        ([(1500, 1579)], [3000]),
        ([(700, 760), (1500, 1579), (3300, 3350)], [20, 2000]),
    ],
)
def test_a_sensor_that_stood_still_again_or_beside_a_spike_is_found(rows: list[tuple[int, int]], places: list[int]) -> None:
    values = moving(2, 0.05)
    for first, last in rows:
        values[first : last + 1] = values[first]
    values[places] += 300.0
    assert freezes(values) == rows
    assert list(spikes(values)) == places


@pytest.mark.parametrize("seed", range(5))
def test_a_noisy_sensor_that_stands_still_to_the_end_is_found(seed: int) -> None:
    values = np.random.default_rng(seed).normal(3.0, 0.1, N)
    values[3000:] = values[3000]
    assert freezes(values) == [(3000, N - 1)]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("turn", "speed"), [(360.0, 50.0), (360.0, -200.0), (2.0 * np.pi, 0.7), (65536.0, 9000.0), (4096.0, -700.0)]
)
@pytest.mark.parametrize("centred", [False, True])
def test_a_reading_that_wraps_around_is_found_where_it_does(seed: int, turn: float, speed: float, centred: bool) -> None:
    generator = np.random.default_rng(seed)
    time = np.arange(N) / 200.0
    whole = (
        generator.uniform(0.0, turn) + speed * (time + 0.2 * np.sin(3.0 * time)) + 1e-4 * turn * generator.standard_normal(N)
    )
    values = np.mod(whole, turn) - (turn / 2.0 if centred else 0.0)
    np.testing.assert_array_equal(wraps(values), np.flatnonzero(np.abs(np.diff(values)) > turn / 2.0) + 1)
    assert len(spikes(values)) == 0


@pytest.mark.parametrize("seed", range(20))
def test_what_is_set_or_switched_does_not_wrap(seed: int) -> None:
    noise = np.random.default_rng(seed).normal(0.0, 0.1, N)
    level = np.where(np.arange(N) < 2000, 0.0, 30.0)
    assert len(wraps(level + noise)) == len(wraps(30.0 * ((np.arange(N) // 400) % 2) + noise)) == 0
    swing = moving(seed, 0.05)
    swing[2000:] -= 70.0
    assert len(wraps(swing)) == 0


@pytest.mark.parametrize("none", [-9999.0, 9999.0, 1e30, -32768.0])
@pytest.mark.parametrize("rows", [slice(100, 130), slice(0, 40), slice(N - 30, N), slice(None, None, 5)])
def test_a_value_that_stands_for_no_reading_is_found(none: float, rows: slice) -> None:
    values = moving(3, 0.05)
    values[rows] = none
    np.testing.assert_array_equal(no_readings(values), np.arange(N)[rows])


def test_short_and_unfinished_columns_have_none() -> None:
    assert len(spikes(np.array([0.0, 9.0, 0.0]))) == 0 and freezes(np.array([0.0, 0.0, 9.0])) == []
    assert len(spikes(np.full(N, np.nan))) == 0 and freezes(np.full(N, np.nan)) == []


def test_a_log_says_where_its_sensor_jumps_or_stands_still() -> None:
    log = make_log(1200)
    log.columns["pressure1_mpa"][300] += 0.4
    held = log.columns["pressure2_mpa"]
    held[400:500] = held[400]
    held[500:] += 0.2
    told = {one.field: one.line for one in findings(log)}
    assert "a reading jumps out and back by far more than any other step" in told["pressure1_mpa"]
    assert "'spikes: interpolate' in the map" in told["pressure1_mpa"]
    assert "in 100 samples, 0.4 to 0.499 s, and jumps on from there" in told["pressure2_mpa"]


def test_spikes_are_kept_and_told_or_filled_in(tmp_path: Path) -> None:
    time, generator = np.arange(1000) * 1e-3, np.random.default_rng(1)
    true = 10.0 * np.sin(12.0 * time)
    arm = true.copy()
    arm[[250, 700]] += 30.0
    table = np.column_stack([time, arm, 3.0 * true, 4.0 * true, *(0.1 + 1e-3 * generator.standard_normal((2, 1000)))])
    np.savetxt(tmp_path / "table.csv", table, delimiter=",", header="t,arm,pump,command,p1,p2", comments="")
    fields = {
        "time_s": "t", "arm_deg": "arm", "pump_deg": "pump", "command_deg": "command", "pressure1_mpa": "p1", "pressure2_mpa": "p2",
    }  # fmt: skip
    mapping = tmp_path / "map.yaml"
    mapping.write_text(yaml.safe_dump({"fields": fields}))
    [kept] = import_files([tmp_path / "table.csv"], mapping, [tmp_path / "kept.mcap"])
    assert any("'arm_deg': 2 readings jump out and back" in one.line for one in kept.doubtful)
    assert read_log(kept.path).columns["arm_deg"] == pytest.approx(arm)
    mapping.write_text(yaml.safe_dump({"fields": fields, "spikes": "interpolate"}))
    [filled] = import_files([tmp_path / "table.csv"], mapping, [tmp_path / "filled.mcap"])
    assert any("at 0.25 s); filled in" in one.line for one in filled.doubtful)
    assert read_log(filled.path).columns["arm_deg"] == pytest.approx(true, abs=2e-3)
    mapping.write_text(yaml.safe_dump({"fields": fields, "spikes": "interpolte"}))
    with pytest.raises(UsageError, match=r"'interpolte' in spikes of .*did you mean 'interpolate'"):
        import_files([tmp_path / "table.csv"], mapping, [tmp_path / "other.mcap"])
