"""Finding logs, and which of them are repetitions of each other."""

from __future__ import annotations

from pathlib import Path

import pytest
from log_makers import METADATA, make_columns, make_log

from hjcamp.errors import UsageError
from hjcamp.records.find import find_logs, group_by_condition, read_logs, refuse_mixed_hardware
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """Return a run folder with two conditions of two repetitions each."""
    for condition in ("sine", "ramp"):
        for number in (1, 2):
            metadata = METADATA | {"condition": condition, "repetition": str(number)}
            write_log(tmp_path / f"run/logs/{condition}/rep_{number:02}.mcap", TestLog(make_columns(20), metadata))
    (tmp_path / "run/config.yaml").write_text("a: 1\n")
    (tmp_path / "run/logs/ramp/rep_03.mcap.part").write_bytes(b"half")
    return tmp_path / "run"


def test_run_folder_folder_and_files_are_the_same(run: Path) -> None:
    expected = [run / "logs" / name for name in ("ramp/rep_01", "ramp/rep_02", "sine/rep_01", "sine/rep_02")]
    expected = [path.with_suffix(".mcap") for path in expected]
    assert find_logs([run]) == find_logs([run / "logs"]) == find_logs([run.parent]) == expected
    assert find_logs([*reversed(expected), run / "logs" / "ramp", str(run)]) == expected


def test_repetitions_are_grouped(run: Path) -> None:
    groups = group_by_condition(read_logs([run]))
    assert {name: len(logs) for name, logs in groups.items()} == {"ramp": 2, "sine": 2}
    assert [log.metadata["repetition"] for log in groups["sine"]] == ["1", "2"]


def test_what_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no logs were named"):
        find_logs([])
    with pytest.raises(UsageError, match="nothing: there is no such file or folder"):
        find_logs([tmp_path / "nothing"])
    with pytest.raises(UsageError, match=r"there are no logs \(\*\.mcap\) in this folder$"):
        find_logs([tmp_path])
    (tmp_path / "a.mcap.part").write_bytes(b"half")
    with pytest.raises(UsageError, match=r"1 unfinished ones \(\*\.part\) can be recovered"):
        find_logs([tmp_path])


def test_mixed_hardware_is_refused() -> None:
    one, two = make_log(10), make_log(10)
    one.metadata["pump"] = two.metadata["pump"] = "pump2"
    refuse_mixed_hardware([one, two, make_log(10)])
    two.metadata["pump"] = "pump1"
    with pytest.raises(UsageError, match=r"mixed hardware: pump is 'pump2' in .* and 'pump1' in"):
        refuse_mixed_hardware([one, two])
