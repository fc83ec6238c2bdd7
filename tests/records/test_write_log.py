"""Writing whole logs, and logs that grow while a test runs."""

from __future__ import annotations

import hashlib
import io
import os
import resource
from pathlib import Path

import numpy as np
import pytest
import zstandard
from log_makers import FIELD_NAMES, make_columns, make_log, rows
from mcap.reader import make_reader
from mcap.records import Chunk, MessageIndex, Metadata, Schema
from mcap.stream_reader import StreamReader

import hjcamp.records.write as write_module
from hjcamp.errors import HjcampError, UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log
from hjcamp.records.write import LogWriter, start_time_ns, write_log


def test_what_was_written_is_read(tmp_path: Path) -> None:
    log = make_log(samples=1300, before=200)
    write_log(tmp_path / "folder" / "rep_01.mcap", log)
    back = read_log(tmp_path / "folder" / "rep_01.mcap")
    assert list(back.columns) == list(FIELD_NAMES)
    for name, values in log.columns.items():
        np.testing.assert_array_equal(back.columns[name], values)
    assert back.metadata == log.metadata and back.attachments == log.attachments
    assert [path.name for path in (tmp_path / "folder").iterdir()] == ["rep_01.mcap"]


def test_equal_logs_give_equal_bytes(tmp_path: Path) -> None:
    for name in ("a.mcap", "b.mcap"):
        write_log(tmp_path / name, make_log())
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_absent_fields_stay_absent_and_zeros_are_written(tmp_path: Path) -> None:
    columns = make_columns()
    for name in ("phase", "reference_deg", "pump_deg", "pid_deg", "dither_v"):
        del columns[name]
    write_log(tmp_path / "few.mcap", TestLog(columns))
    back = read_log(tmp_path / "few.mcap")
    assert set(back.columns) == set(columns)
    assert (back.columns["feedforward_deg"] == 0).all()


def test_the_mcap_library_reads_it(tmp_path: Path) -> None:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    log = make_log(samples=1200)
    write_log(tmp_path / "a.mcap", log)
    data = (tmp_path / "a.mcap").read_bytes()
    reader = make_reader(io.BytesIO(data), validate_crcs=True)
    summary = reader.get_summary()
    assert summary is not None and summary.statistics is not None
    assert summary.statistics.message_count == 1200 and len(summary.chunk_indexes) == 3
    assert [record.name for record in reader.iter_metadata()] == ["hjcamp.test"]
    assert [record.name for record in reader.iter_attachments()] == ["config.yaml"]
    pool = descriptor_pool.DescriptorPool()
    schema, channel, _ = next(iter(reader.iter_messages()))
    assert schema is not None and (schema.name, schema.encoding) == ("hjcamp.Sample", "protobuf")
    assert (channel.topic, channel.message_encoding) == ("/test/sample", "protobuf")
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
        pool.Add(file)
    message = message_factory.GetMessageClass(pool.FindMessageTypeByName("hjcamp.Sample"))
    for index, (_, _, record) in enumerate(reader.iter_messages()):
        assert record.log_time == record.publish_time == 1_795_237_200_000_000_000 + index * 1_000_000
        sample = message.FromString(record.data)
        assert sample.arm_deg == log.columns["arm_deg"][index] and sample.HasField("feedforward_deg")
    assert sum(1 for _ in StreamReader(io.BytesIO(data), validate_crcs=True).records) > 1200


def test_the_message_index_points_at_the_messages(tmp_path: Path) -> None:
    write_log(tmp_path / "a.mcap", make_log(samples=1200))
    content = tmp_path.joinpath("a.mcap").read_bytes()
    sequence = 0
    chunk = b""
    for record in StreamReader(io.BytesIO(content), emit_chunks=True).records:
        if isinstance(record, Chunk):
            chunk = zstandard.decompress(record.data)
        elif isinstance(record, MessageIndex):
            for log_time, offset in record.records:
                assert chunk[offset] == 5
                assert int.from_bytes(chunk[offset + 11 : offset + 15], "little") == sequence
                assert int.from_bytes(chunk[offset + 15 : offset + 23], "little") == log_time
                sequence += 1
    assert sequence == 1200


def test_the_bytes_of_a_pump_joint_log_stay_what_they_were(tmp_path: Path) -> None:
    write_log(tmp_path / "a.mcap", make_log(samples=1300, before=200))
    records = list(StreamReader(io.BytesIO((tmp_path / "a.mcap").read_bytes()), emit_chunks=True).records)
    messages = b"".join(zstandard.decompress(record.data) for record in records if isinstance(record, Chunk))
    [schema] = {record.data for record in records if isinstance(record, Schema)}
    golden = (
        "07b335777f0c862ef74f6b06447baadbab20e435d0f3b7d177d66bc37a838159",
        "fe4cf17477e6e9aa850e14e2065c680f2a5f3ce17ea7786b27ee0e2dc19a358e",
    )
    assert tuple(hashlib.sha256(data).hexdigest() for data in (messages, schema)) == golden
    assert [record.metadata for record in records if isinstance(record, Metadata)] == [make_log().metadata]


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("2026-11-21T05:00:00Z", 1_795_237_200),
        ("2026-11-21T06:00:00+01:00", 1_795_237_200),
        ("2026-11-21T05:00:00", 1_795_237_200),
        ("yesterday", 1_000_000_000),
        ("1950-01-01", 1_000_000_000),
    ],
)
def test_start_time(text: str, seconds: int) -> None:
    assert start_time_ns({"started_at": text}) == seconds * 10**9
    assert start_time_ns({}) == 10**18


def test_columns_that_are_no_log_are_refused(tmp_path: Path) -> None:
    target = tmp_path / "a.mcap"
    columns = make_columns()
    with pytest.raises(UsageError, match=r"unknown field 'arm_degree'.*did you mean 'arm_deg'"):
        write_log(target, TestLog(columns | {"arm_degree": columns["arm_deg"]}))
    with pytest.raises(UsageError, match="required field 'arm_deg' is missing"):
        write_log(target, TestLog({name: values for name, values in columns.items() if name != "arm_deg"}))
    with pytest.raises(UsageError, match="one shape"):
        write_log(target, TestLog(columns | {"arm_deg": columns["arm_deg"][:-1]}))
    with pytest.raises(UsageError, match="hold a sample"):
        write_log(target, TestLog({name: values[:0] for name, values in columns.items()}))
    broken = columns["pump_deg"].copy()
    broken[17] = np.nan
    with pytest.raises(HjcampError, match="'pump_deg' is nan at sample 17"):
        write_log(target, TestLog(columns | {"pump_deg": broken}))
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_refuses_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_log(tmp_path / "a.mcap", make_log(samples=50))
    before = (tmp_path / "a.mcap").read_bytes()

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(write_module.os, "fsync", full)
    with pytest.raises(HjcampError, match=r"a\.mcap\.part: cannot be written: No space left on device"):
        write_log(tmp_path / "a.mcap", make_log(samples=60))
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]
    assert (tmp_path / "a.mcap").read_bytes() == before


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(HjcampError, match="cannot be written"):
        write_log(tmp_path / "file" / "a.mcap", make_log(samples=10))


def test_growing_log_equals_the_whole_one(tmp_path: Path) -> None:
    columns = make_columns(samples=450)
    with LogWriter(tmp_path / "rig.mcap", FIELD_NAMES, {"condition": "x"}) as writer:
        for sample in rows({name: values[:250] for name, values in columns.items()}):
            writer.append(sample)
        writer.append_many({name: values[250:] for name, values in columns.items()})
        assert not writer.path.exists()
    back = read_log(tmp_path / "rig.mcap")
    for name, values in columns.items():
        np.testing.assert_array_equal(back.columns[name], values)


def test_a_power_cut_costs_at_most_a_fifth_of_a_second(tmp_path: Path) -> None:
    columns = make_columns(samples=2000)
    writer = LogWriter(tmp_path / "rig.mcap", FIELD_NAMES, {"condition": "x"}, {"config.yaml": b"a: 1\n"})
    worst = 0
    for count, sample in enumerate(rows(columns), start=1):
        writer.append(sample)
        if count % 333 == 0:
            copy = tmp_path / f"cut_{count}.mcap.part"
            copy.write_bytes(writer.part.read_bytes())  # what is on the disk at this moment
            recovered = recover_log(copy, tmp_path / f"saved_{count}.mcap")
            worst = max(worst, count - recovered.kept)
            saved = read_log(recovered.path)
            assert saved.metadata == {"condition": "x"} and saved.attachments == {"config.yaml": b"a: 1\n"}
            np.testing.assert_array_equal(saved.columns["arm_deg"], columns["arm_deg"][: recovered.kept])
    writer.abort()
    assert worst <= 200


def test_abort_leaves_a_part_that_can_be_recovered(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), LogWriter(tmp_path / "rig.mcap", FIELD_NAMES, {}) as writer:
        for sample in rows(make_columns(samples=150)):
            writer.append(sample)
        raise KeyboardInterrupt
    assert not (tmp_path / "rig.mcap").exists()
    assert recover_log(writer.part, tmp_path / "saved.mcap").kept == 150


def test_a_disk_that_fills_during_a_test_leaves_what_was_logged(tmp_path: Path) -> None:
    writer = LogWriter(tmp_path / "rig.mcap", FIELD_NAMES, {"condition": "x"})
    columns = make_columns(samples=1500)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, hard))
    try:
        with pytest.raises(HjcampError, match=r"rig\.mcap\.part: cannot be written"):
            for sample in rows(columns):
                writer.append(sample)
        part = writer.abort()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert not writer.path.exists()
    recovery = recover_log(part, tmp_path / "saved.mcap")
    assert recovery.kept >= writer.samples - 200 > 100
    np.testing.assert_array_equal(read_log(recovery.path).columns["pressure1_mpa"], columns["pressure1_mpa"][: recovery.kept])


def test_a_growing_log_never_overwrites(tmp_path: Path) -> None:
    write_log(tmp_path / "a.mcap", make_log(samples=20))
    with pytest.raises(UsageError, match="exists already"):
        LogWriter(tmp_path / "a.mcap", FIELD_NAMES, {})
    assert os.listdir(tmp_path) == ["a.mcap"]


def test_a_sample_without_a_time_is_refused(tmp_path: Path) -> None:
    columns = make_columns(samples=5)
    columns["time_s"][2] = np.nan
    writer = LogWriter(tmp_path / "a.mcap", FIELD_NAMES, {})
    with pytest.raises(HjcampError, match="without a time"):
        writer.append_many(columns)
    writer.abort()
