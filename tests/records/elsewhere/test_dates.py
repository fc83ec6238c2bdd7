"""Dates and times as loggers of several countries write them, beside numbers with points or commas."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
import yaml

from hjcamp.errors import UsageError
from hjcamp.records.elsewhere.importing import import_file
from hjcamp.records.log import TestLog

MAPPING = {
    "plant": "valve_joint",
    "fields": {
        "time_s": "t",
        "arm_deg": "arm",
        "pressure1_mpa": "p1",
        "pressure2_mpa": "p2",
        **{f"valve{k}_ratio": "c" for k in range(1, 5)},
    },
}
STEP = 0.01


def brought(folder: Path, began: datetime, form: str, comma: bool = False) -> TestLog:
    rows = []
    for k in range(1000):
        noise = 0.01 * np.sin(k**2)
        values = [f"{one:.6f}" for one in (0.01 * k, 0.1 + noise, 0.2 - noise, 0.0)]
        stamp = (began + timedelta(seconds=STEP * k)).strftime(form)
        row = ";".join([stamp, *values])
        rows.append(";".join([stamp, *(one.replace(".", ",") for one in values)]) if comma else row)
    (folder / "bench.csv").write_text("\n".join(["t;arm;p1;p2;c", *rows]) + "\n")
    (folder / "map.yaml").write_text(yaml.safe_dump(MAPPING))
    return import_file(folder / "bench.csv", folder / "map.yaml", folder / "out.mcap")


@pytest.mark.parametrize(
    ("began", "form"),
    [
        (datetime(2024, 1, 31, 23, 59, 55), "%Y-%m-%d %H:%M:%S.%f"),
        # noon, midnight and the end of a month within the test; the month before the day, and behind it
        (datetime(2024, 1, 5, 11, 59, 55), "%m/%d/%Y %I:%M:%S.%f %p"),
        (datetime(2024, 1, 31, 23, 59, 55), "%m/%d/%Y %I:%M:%S.%f %p"),
        (datetime(2024, 1, 31, 23, 59, 55), "%m/%d/%Y %H:%M:%S.%f"),
        (datetime(2024, 4, 30, 23, 59, 55), "%d/%m/%Y %H:%M:%S.%f"),
        # both ways can be read, one of them does not go on
        (datetime(2024, 5, 6, 23, 59, 55), "%m/%d/%Y %H:%M:%S.%f"),
        (datetime(2024, 5, 6, 23, 59, 55), "%d/%m/%Y %H:%M:%S.%f"),
        (datetime(2024, 1, 31, 23, 59, 55), "%d.%m.%Y %H:%M:%S.%f"),
    ],
)
@pytest.mark.parametrize("comma", [False, True])
def test_written_times_are_seconds(tmp_path: Path, began: datetime, form: str, comma: bool) -> None:
    log = brought(tmp_path, began, form, comma)
    np.testing.assert_allclose(log.columns["time_s"], STEP * 10 * np.arange(log.samples) / 10, atol=1e-3)
    assert np.ptp(log.columns["time_s"]) == pytest.approx(999 * STEP, rel=0.01)
    assert np.ptp(log.columns["arm_deg"]) == pytest.approx(9.99, abs=1e-3)


def test_text_that_is_no_time_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="'t' is no number in row 1"):
        brought(tmp_path, datetime(2024, 1, 31), "monday %H")
