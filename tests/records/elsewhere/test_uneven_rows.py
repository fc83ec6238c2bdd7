"""Tables of loggers whose stamps are whole ticks of a slow clock, or whose rows are uneven all along."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.clock import uneven_words, usual_step
from hjcamp.records.elsewhere.importing import import_file
from hjcamp.records.log import TestLog
from hjcamp.records.read import read_log

MAPPING = {
    "plant": "valve_joint",
    "fields": {
        "time_s": {"column": "t", "unit": "ms"},
        "arm_deg": "arm",
        "pressure1_mpa": "p1",
        "pressure2_mpa": "p2",
        **{f"valve{k}_ratio": "c" for k in range(1, 5)},
    },
}


def brought(folder: Path, stamps: np.ndarray, **more: object) -> TestLog:
    noise = 0.01 * np.sin(np.arange(len(stamps)) ** 2)
    rows = [
        f"{'' if np.isnan(t) else format(t, '.6g')},{0.01 * np.nan_to_num(t):.9g},{0.1 + one:.6g},{0.2 - one:.6g},0"
        for t, one in zip(stamps, noise, strict=True)
    ]
    (folder / "bench.csv").write_text("\n".join(["t,arm,p1,p2,c", *rows]) + "\n")
    (folder / "map.yaml").write_text(yaml.safe_dump(MAPPING | more))
    import_file(folder / "bench.csv", folder / "map.yaml", folder / "out.mcap")
    return read_log(folder / "out.mcap")


def test_stamps_in_whole_ticks_of_a_slow_clock_are_no_gaps() -> None:
    # 1.3 ms between rows on a clock of 1 ms: steps of 1 and 2 ms
    time = np.floor(1.3 * np.arange(2000)) * 1e-3
    assert usual_step(time, "here") == pytest.approx(1.3e-3, rel=1e-3)
    lost = np.delete(time, slice(700, 704))
    with pytest.raises(UsageError, match="gap of 7"):
        usual_step(lost, "here")


def test_rows_that_are_whole_ticks_apart_have_gaps_as_before() -> None:
    time = np.arange(500) * 1e-3
    assert usual_step(time, "here") == pytest.approx(1e-3)
    with pytest.raises(UsageError, match="gap of 2"):
        usual_step(np.delete(time, 77), "here")


def test_rows_that_are_uneven_all_along_are_brought_to_a_period(tmp_path: Path) -> None:
    stamps = np.cumsum(np.random.default_rng(1).uniform(2.0, 7.0, 900))
    with pytest.raises(UsageError, match=r"uneven all along, say in the map resample_s: 0\.00"):
        brought(tmp_path, stamps)
    log = brought(tmp_path, stamps, resample_s="5e-3")
    assert log.period == pytest.approx(0.005)
    time = log.columns["time_s"]
    np.testing.assert_allclose(log.columns["arm_deg"], 10.0 * (time + 1e-3 * stamps[0]), rtol=1e-5)


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        ((2.0, 8.0), "rows are 2 ms to 8 ms apart: brought to one each 5 ms"),
        ((4.1, 5.9), "rows are 4.1 ms to 5.9 ms apart: brought to one each 5 ms"),
        ((4.8, 5.2), ""),
    ],
)
def test_uneven_rows_are_told(steps: tuple[float, float], said: str) -> None:
    time = 1e-3 * np.concatenate([[0.0], np.cumsum(np.tile(steps, 300))])
    assert uneven_words(time, 5e-3).startswith(said) if said else not uneven_words(time, 5e-3)
    # nor are two rates one with broken ticks
    two = 1e-3 * np.concatenate([10.0 * np.arange(200), 2000.0 + 20.0 * np.arange(200)])
    assert uneven_words(two, 15e-3).startswith("rows are 10 ms to 20 ms apart")
    # one tick more or less of a slow clock is no uneven row
    assert not uneven_words(np.floor(1.3 * np.arange(2000)) * 1e-3, 1.3e-3)


def test_a_row_without_its_time_is_not_filled_in(tmp_path: Path) -> None:
    stamps = 5.0 * np.arange(40)
    stamps[7] = np.nan
    with pytest.raises(UsageError, match=r"'time_s' is nan at sample 7.*a row without its time is to be deleted"):
        brought(tmp_path, stamps, gaps="interpolate")


@pytest.mark.parametrize("stamped", [False, True])
def test_a_table_of_blanks_without_a_header_and_written_times(tmp_path: Path, stamped: bool) -> None:
    time = 0.002 * np.arange(400)
    noise = 0.01 * np.sin(np.arange(400) ** 2)
    first = [f"2026-01-31T12:00:{t:09.6f}" if stamped else f"{t:.4f}" for t in time]
    rows = [f" {a}   {10.0 * t:9.5f} {0.1 + n:.6f}  {0.2 - n:.6f} 0" for a, t, n in zip(first, time, noise, strict=True)]
    (tmp_path / "bench.dat").write_text("\n".join(rows) + "\n")
    fields = {"time_s": 1, "arm_deg": 2, "pressure1_mpa": 3, "pressure2_mpa": 4, **{f"valve{k}_ratio": 5 for k in range(1, 5)}}
    (tmp_path / "map.yaml").write_text(yaml.safe_dump({"plant": "valve_joint", "fields": fields}))
    import_file(tmp_path / "bench.dat", tmp_path / "map.yaml", tmp_path / "out.mcap")
    log = read_log(tmp_path / "out.mcap")
    assert log.period == pytest.approx(0.002)
    np.testing.assert_allclose(log.columns["arm_deg"], 10.0 * log.columns["time_s"], atol=1e-5)


@pytest.mark.parametrize(("on", "off"), [("True", "False"), ("ON", "off"), ("true", "false")])
def test_what_is_on_or_off_and_times_of_a_day_are_numbers(tmp_path: Path, on: str, off: str) -> None:
    time = 0.002 * np.arange(400)
    valve = (np.arange(400) // 50) % 2
    noise = 0.01 * np.sin(np.arange(400) ** 2)
    said = np.where(valve, on, off)
    rows = [
        f"12:00:{t:09.6f},{10.0 * t:.5f},{0.1 + n:.6f},{0.2 - n:.6f},{v}" for t, n, v in zip(time, noise, said, strict=True)
    ]
    (tmp_path / "bench.csv").write_text("\n".join(["t,arm,p1,p2,c", *rows]) + "\n")
    fields = {**MAPPING["fields"], "time_s": "t"}  # type: ignore[dict-item]
    (tmp_path / "map.yaml").write_text(yaml.safe_dump({"plant": "valve_joint", "fields": fields}))
    import_file(tmp_path / "bench.csv", tmp_path / "map.yaml", tmp_path / "out.mcap")
    log = read_log(tmp_path / "out.mcap")
    assert log.period == pytest.approx(0.002)
    np.testing.assert_array_equal(log.columns["valve1_ratio"], valve)
    np.testing.assert_allclose(log.columns["arm_deg"], 10.0 * log.columns["time_s"], atol=1e-5)


def test_no_samples_are_made_up_between_rows(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="samples between rows would be made up"):
        brought(tmp_path, np.arange(400) * 5.0, resample_s=0.001)
    for wrong, said in (("fast", "not a finite number"), (0, "allowed"), (-0.01, "allowed"), (None, "not a finite number")):
        with pytest.raises(UsageError, match=f"resample_s is .*{said}"):
            brought(tmp_path, np.arange(400) * 5.0, resample_s=wrong)

    with pytest.raises(UsageError, match="resample_s is too long"):
        brought(tmp_path, np.arange(400) * 5.0, resample_s=3.0)


def test_what_would_change_numbers_without_a_word_is_refused(tmp_path: Path) -> None:
    """A mark for thousands, two columns of one name, and a decimal comma that is neither yes nor no."""
    rows = [f"{k};{945 + k};0,1{k % 7};0,2{k % 5};0" for k in range(400)]
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(MAPPING))

    def refused(head: str, lines: list[str]) -> str:
        (tmp_path / "bench.csv").write_text("\n".join([head, *lines]) + "\n")
        with pytest.raises(UsageError) as problem:
            import_file(tmp_path / "bench.csv", tmp_path / "map.yaml", tmp_path / "out.mcap")
        return str(problem.value)

    thousands = [row.replace(";1", ";1.", 1) if ";1" in row[:6] else row for row in rows]
    assert "where the table has decimal commas; a mark for thousands" in refused("t;arm;p1;p2;c", thousands)
    assert "several columns are called 'arm'" in refused("t;arm;p1;p2;c;arm", [f"{row};1" for row in rows])
    assert "where units stand below the header" in refused("t;arm;p1;p2;c", ["ms;deg;MPa;MPa;1", *rows])
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(MAPPING | {"decimal_comma": "yes, please"}))
    assert "true or false is needed" in refused("t;arm;p1;p2;c", rows)


def test_a_table_as_windows_writes_it_is_read(tmp_path: Path) -> None:
    noise = 0.01 * np.sin(np.arange(400) ** 2)
    rows = [f"{5 * k},{0.05 * k:.6f},{0.1 + n:.6f},{0.2 - n:.6f},0" for k, n in zip(range(400), noise, strict=True)]
    for name, head, coding in (("a", "t,Winkel in °,p1,p2,c", "cp1252"), ("b", "\ufefft,Winkel in °,p1,p2,c", "utf-8")):
        (tmp_path / "bench.csv").write_bytes("\r\n".join([head, *rows]).encode(coding))
        fields = MAPPING["fields"] | {"arm_deg": "Winkel in °"}  # type: ignore[operator]
        (tmp_path / "map.yaml").write_text(yaml.safe_dump(MAPPING | {"fields": fields}))
        import_file(tmp_path / "bench.csv", tmp_path / "map.yaml", tmp_path / f"{name}.mcap")
        assert read_log(tmp_path / f"{name}.mcap").columns["arm_deg"][-1] == pytest.approx(0.05 * 399)


def test_a_few_missing_rows_are_no_reason_for_a_longer_period(tmp_path: Path) -> None:
    stamps = 40.0 * np.arange(400)
    for lost in ([100, 101], [50, *range(200, 230)]):
        with pytest.raises(UsageError, match=r"gap of .* as tests of their own$") as caught:
            brought(tmp_path, np.delete(stamps, lost), resample_s="0.04")
        assert "resample_s" not in str(caught.value)


def test_one_long_hole_is_no_tick_of_a_clock() -> None:
    time = np.concatenate([np.arange(119.0), np.arange(225.0, 543.0)])
    with pytest.raises(UsageError, match=r"gap of 107 s after row 119 .* import what is before and after it"):
        usual_step(time, "log.csv", wanted=1.0)
