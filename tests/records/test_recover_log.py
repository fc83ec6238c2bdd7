"""Verifying logs, and saving what is whole in damaged ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from log_makers import json_file, make_columns, make_log, rows
from mcap.writer import CompressionType

from hjcamp.errors import UsageError
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log, verify_log
from hjcamp.records.write import write_log

SAMPLES = 3000


@pytest.fixture
def good(tmp_path: Path) -> bytes:
    """Return the bytes of a log of six chunks."""
    write_log(tmp_path / "good.mcap", make_log(samples=SAMPLES))
    return (tmp_path / "good.mcap").read_bytes()


def chunk_starts(content: bytes) -> list[int]:
    """Return where the chunks start, found by the name of their compression."""
    starts = []
    at = content.find(b"\x04\x00\x00\x00zstd")
    while at >= 0:
        if content[at - 37] == 6:
            starts.append(at - 37)
        at = content.find(b"\x04\x00\x00\x00zstd", at + 1)
    return starts


def test_a_whole_log_is_verified(tmp_path: Path, good: bytes) -> None:
    report = verify_log(tmp_path / "good.mcap")
    assert report.whole and report.problems == ()
    assert (report.samples, report.duration) == (SAMPLES, pytest.approx(3.0))
    assert "arm_deg" in report.fields and report.attachments == ("config.yaml",)
    assert report.metadata["condition"] == "ramp"


def test_remarks_do_not_make_a_log_unusable(tmp_path: Path) -> None:
    samples = rows(make_columns(samples=50))
    del samples[3]["reference_deg"]
    for sample in samples:
        sample["time_s"] += 5.0
    (tmp_path / "a.mcap").write_bytes(json_file(samples))
    report = verify_log(tmp_path / "a.mcap")
    assert report.whole and len(report.problems) == 2
    assert "'reference_deg' is missing in 1 of 50" in report.problems[0] and "starts at time 5 s" in report.problems[1]


@pytest.mark.parametrize("share", [0.3, 0.5, 0.9, 0.999])
def test_a_cut_log_keeps_everything_before_the_cut(tmp_path: Path, good: bytes, share: float) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(good[: int(len(good) * share)])
    with pytest.raises(UsageError, match="hjcamp log recover"):
        read_log(cut)
    report = verify_log(cut)
    recovery = recover_log(cut, tmp_path / "saved.mcap")
    saved = read_log(tmp_path / "saved.mcap")
    whole_chunks = sum(start < len(good) * share for start in chunk_starts(good)) - 1
    assert recovery.kept == saved.samples == report.samples >= whole_chunks * 500
    assert not report.whole and "truncated" in report.problems[0]
    assert saved.metadata == make_log().metadata and saved.attachments == make_log().attachments
    np.testing.assert_array_equal(saved.columns["pump_deg"], make_columns(SAMPLES)["pump_deg"][: recovery.kept])
    assert recovery.lost_is_exact == (share == 0.999)  # the statistics are near the end
    assert recovery.lost <= SAMPLES - recovery.kept


def test_what_is_not_known_of_a_cut_log_is_said(tmp_path: Path, good: bytes) -> None:
    (tmp_path / "cut.mcap").write_bytes(good[: len(good) // 2])
    recovery = recover_log(tmp_path / "cut.mcap", tmp_path / "saved.mcap")
    saved = read_log(tmp_path / "saved.mcap")
    assert not recovery.lost_is_exact and recovery.lost == 0
    assert recovery.until == saved.columns["time_s"][-1] and recovery.phase == saved.columns["phase"][-1]
    assert recovery.words == (
        f"{saved.samples} samples kept, the last at {recovery.until:.3f} s in phase 3 (command and control); "
        "how many came after it is not known: the file does not say how many it held"
    )
    (tmp_path / "whole.mcap").write_bytes(good)
    assert recover_log(tmp_path / "whole.mcap", tmp_path / "again.mcap").words == f"{SAMPLES} samples kept, 0 lost"


def test_what_misses_in_between_is_counted(tmp_path: Path, good: bytes) -> None:
    starts = chunk_starts(good)
    (tmp_path / "cut.mcap").write_bytes(good[: starts[2]] + good[starts[3] : len(good) // 5 * 4])
    recovery = recover_log(tmp_path / "cut.mcap", tmp_path / "saved.mcap")
    assert not recovery.lost_is_exact and recovery.lost >= 400
    assert f"samples kept, {recovery.lost} lost among them, the last at" in recovery.words


def test_a_broken_chunk_costs_only_itself(tmp_path: Path, good: bytes) -> None:
    starts = chunk_starts(good)
    broken = bytearray(good)
    broken[starts[2] + 1000] ^= 0xFF
    (tmp_path / "broken.mcap").write_bytes(broken)
    recovery = recover_log(tmp_path / "broken.mcap", tmp_path / "saved.mcap")
    assert recovery.kept + recovery.lost == SAMPLES and recovery.lost_is_exact and 0 < recovery.lost <= 505
    with pytest.raises(UsageError, match=rf"gap of .* {recovery.lost} samples are missing in 1 gap"):
        read_log(tmp_path / "saved.mcap")


def test_a_wrong_length_in_front_of_a_chunk_costs_nothing(tmp_path: Path, good: bytes) -> None:
    broken = bytearray(good)
    broken[chunk_starts(good)[1] + 6] ^= 0x40  # the record now seems to be 64 TiB long
    (tmp_path / "broken.mcap").write_bytes(broken)
    recovery = recover_log(tmp_path / "broken.mcap", tmp_path / "saved.mcap")
    assert (recovery.kept, recovery.lost) == (SAMPLES, 0)
    assert read_log(tmp_path / "saved.mcap").samples == SAMPLES


def test_a_wrong_length_elsewhere_goes_on_at_the_next_chunk(tmp_path: Path, good: bytes) -> None:
    broken = bytearray(good)
    broken[good.index(b"\x04\x00\x00\x00zstd") - 37 - 60] ^= 0xFF  # in the schema or the channel
    broken[chunk_starts(good)[1] - 500 * 16 - 14] ^= 0xFF
    (tmp_path / "broken.mcap").write_bytes(broken)
    recovery = recover_log(tmp_path / "broken.mcap", tmp_path / "saved.mcap")
    assert recovery.kept >= SAMPLES - 505


def test_repeated_chunks_are_kept_once(tmp_path: Path, good: bytes) -> None:
    starts = chunk_starts(good)
    (tmp_path / "twice.mcap").write_bytes(good[: starts[3]] + good[starts[1] :])
    assert recover_log(tmp_path / "twice.mcap", tmp_path / "saved.mcap").kept == SAMPLES
    assert read_log(tmp_path / "saved.mcap").samples == SAMPLES


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("chunked", [True, False])
def test_the_logs_of_others_can_be_recovered(tmp_path: Path, compression: CompressionType, chunked: bool) -> None:
    content = json_file(rows(make_columns(samples=900)), compression=compression, use_chunking=chunked)
    (tmp_path / "cut.mcap").write_bytes(content[: int(len(content) * 0.6)])
    recovery = recover_log(tmp_path / "cut.mcap", tmp_path / "saved.mcap")
    saved = read_log(tmp_path / "saved.mcap")
    assert saved.samples == recovery.kept > 300 and saved.metadata["condition"] == "ramp"


@pytest.mark.parametrize("chunked", [True, False])
def test_one_bad_message_costs_only_itself(tmp_path: Path, chunked: bool) -> None:
    samples: list[object] = list(rows(make_columns(samples=900)))
    samples[300] = b"{broken"
    (tmp_path / "bad.mcap").write_bytes(json_file(samples, use_chunking=chunked))
    recovery = recover_log(tmp_path / "bad.mcap", tmp_path / "saved.mcap")
    assert (recovery.kept, recovery.lost) == (899, 1)
    assert len(recovery.problems) == 1 and "is not JSON" in recovery.problems[0]


def test_a_log_that_exists_is_not_overwritten(tmp_path: Path, good: bytes) -> None:
    (tmp_path / "cut.mcap").write_bytes(good[: len(good) // 2])
    with pytest.raises(UsageError, match="exists already"):
        recover_log(tmp_path / "cut.mcap", tmp_path / "good.mcap")
    assert (tmp_path / "good.mcap").read_bytes() == good


def test_nothing_to_recover(tmp_path: Path, good: bytes) -> None:
    (tmp_path / "cut.mcap").write_bytes(good[: chunk_starts(good)[0] + 20])
    with pytest.raises(UsageError, match="nothing can be recovered: holds no messages"):
        recover_log(tmp_path / "cut.mcap", tmp_path / "saved.mcap")
    assert verify_log(tmp_path / "cut.mcap").samples == 0
    assert not (tmp_path / "saved.mcap").exists()
