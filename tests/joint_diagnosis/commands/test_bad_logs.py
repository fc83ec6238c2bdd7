"""Logs that cannot be used: compare, diagnose and add each say so in one line and write nothing."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from discrepancy_answers import Call
from mcap.writer import CompressionType

sys.path.insert(0, str(Path(__file__).parents[2] / "records"))
from log_makers import METADATA, make_columns, rows, write_json

COMMANDS = (
    ("compare", "logs"),
    ("diagnose", "logs", "--effort", "quick"),
    ("add", "leakage", "./logs", "--as", "new"),
)
Samples = list[dict[str, Any]]


def good(folder: Path) -> list[Path]:
    """Write two logs that nothing is wrong with."""
    folder.mkdir()
    return [write_json(folder / f"rep_{number}.mcap", make_columns(400)) for number in (1, 2)]


def check_refused(call: Call, told: str) -> None:
    """Check that every command refuses the logs with one line that tells the file and the fault."""
    for command in COMMANDS:
        answer = call(*command)
        assert answer.code == 2, answer.err
        assert len(answer.err.strip().splitlines()) == 1 and told in answer.err and "rep_2.mcap" in answer.err
    assert sorted(path.name for path in Path().iterdir()) == ["logs"]


def without(name: str) -> Callable[[Samples], object]:
    """Return what takes a field out."""
    return lambda samples: [sample.pop(name) for sample in samples]


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (without("pressure2_mpa"), "required field 'pressure2_mpa' is missing"),
        (lambda samples: [without(name)(samples) for name in ("pump_deg", "command_deg")], "neither 'pump_deg' nor"),
        (lambda samples: samples[7].update(arm_deg=float("nan")), "'arm_deg' is nan at sample 7"),
        (lambda samples: samples.__delitem__(slice(40, 43)), "gap of 4 ms after sample 39"),
        (lambda samples: samples.__delitem__(slice(0, None, 2)), "wrong rate, samples are 2 ms apart"),
        (lambda samples: samples.__delitem__(slice(30, None)), "30 samples in the command phase"),
        (lambda samples: [sample.update(phase=1.0) for sample in samples], "no sample of the command phase"),
    ],
)
def test_spoilt_samples(call: Call, spoil: Callable[[Samples], object], told: str) -> None:
    last = good(Path("logs"))[-1]
    samples = rows(make_columns(400, seed=8))
    spoil(samples)
    names = list(samples[0])
    write_json(last, {name: np.array([sample[name] for sample in samples]) for name in names})
    check_refused(call, told)


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda content: content[: len(content) // 2], "truncated"),
        (lambda content: b"", "empty"),
        (lambda content: content[:600] + bytes([content[600] ^ 4]) + content[601:], "chunk"),
    ],
)
def test_spoilt_files(call: Call, spoil: Callable[[bytes], bytes], told: str) -> None:
    last = good(Path("logs"))[-1]
    last.write_bytes(spoil(last.read_bytes()))
    check_refused(call, told)


def test_mixed_hardware(call: Call) -> None:
    folder = Path("logs")
    folder.mkdir()
    for number, tubing in ((1, "ldpe_300mm"), (2, "hdpe_300mm")):
        write_json(folder / f"rep_{number}.mcap", make_columns(400, seed=number), metadata=METADATA | {"tubing": tubing})
    check_refused(call, "mixed hardware: tubing is 'ldpe_300mm'")


def test_a_wrong_crc(call: Call) -> None:
    last = good(Path("logs"))[-1]
    content = bytearray(write_json(last, make_columns(400), compression=CompressionType.NONE).read_bytes())
    place = content.index(b'"arm_deg": ') + 11
    content[place : place + 1] = b"7"
    last.write_bytes(content)
    check_refused(call, "wrong CRC in the chunk")
