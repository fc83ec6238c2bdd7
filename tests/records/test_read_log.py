"""Reading logs of both encodings, and refusing what is no whole test."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from log_makers import FIELD_NAMES, json_file, make_columns, make_log, rows, write_json
from mcap.writer import CompressionType, Writer

from hjcamp.errors import UsageError
from hjcamp.records.log import TestLog
from hjcamp.records.mcap import layout
from hjcamp.records.read import read_log, read_metadata
from hjcamp.records.write import write_log


@pytest.mark.parametrize("compression", list(CompressionType))
@pytest.mark.parametrize("chunked", [True, False])
def test_json_of_another_logger(tmp_path: Path, compression: CompressionType, chunked: bool) -> None:
    columns = make_columns()
    log = read_log(write_json(tmp_path / "a.mcap", columns, compression=compression, use_chunking=chunked))
    assert list(log.columns) == list(FIELD_NAMES) and log.metadata["condition"] == "ramp"
    for name, values in columns.items():
        np.testing.assert_array_equal(log.columns[name], values)


def test_metadata_are_read_without_the_samples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = write_json(tmp_path / "a.mcap", make_columns())
    expected = read_log(whole).metadata
    (tmp_path / "half.mcap").write_bytes(whole.read_bytes()[:-20])
    monkeypatch.delattr("hjcamp.records.read.SampleDecoder")
    assert read_metadata(whole) == expected and expected
    with pytest.raises(UsageError, match=r"half\.mcap: the file is truncated.*hjcamp log recover"):
        read_metadata(tmp_path / "half.mcap")


def test_json_may_hold_more_and_less(tmp_path: Path) -> None:
    columns = make_columns(samples=50)
    samples = [
        {name: sample[name] for name in ("time_s", "arm_deg", "pressure1_mpa", "pressure2_mpa", "command_deg")}
        | {"room": {"temperature": 21.5}, "phase": 3}
        for sample in rows(columns)
    ]
    del samples[7]["phase"]
    (tmp_path / "a.mcap").write_bytes(json_file(samples, topics=("/test/sample", "/room"), metadata={}))
    log = read_log(tmp_path / "a.mcap")
    assert "pump_deg" not in log.columns and (log.columns["phase"] == 3).all() and log.metadata == {}


def test_messages_out_of_order_are_sorted_by_log_time(tmp_path: Path) -> None:
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    channel = writer.register_channel("/test/sample", "json", writer.register_schema("hjcamp.Sample", "jsonschema", b"{}"))
    samples = rows(make_columns(samples=40))
    for index in [*range(20, 40), *range(20)]:
        writer.add_message(channel, index * 10**6, json.dumps(samples[index]).encode(), index * 10**6)
    writer.finish()
    (tmp_path / "a.mcap").write_bytes(stream.getvalue())
    assert (np.diff(read_log(tmp_path / "a.mcap").columns["time_s"]) > 0).all()


def protobuf_file(
    samples: list[dict[str, Any]], syntax: str, kinds: dict[str, int], reverse: bool = False, noise: bool = False
) -> bytes:
    """Return a log by a standard protobuf serialiser: numbers of its own, and messages on another topic."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file = descriptor_pb2.FileDescriptorProto(name="other.proto", package="hjcamp", syntax=syntax)
    message = file.message_type.add(name="Sample")
    for index, (name, kind) in enumerate(reversed(kinds.items()) if reverse else kinds.items()):
        message.field.add(name=name, number=3 + 5 * index, type=kind, label=1)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    kind_of_message = message_factory.GetMessageClass(pool.FindMessageTypeByName("hjcamp.Sample"))
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=8192)
    writer.start()
    content = descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString()
    schema = writer.register_schema("hjcamp.Sample", "protobuf", content)
    other = writer.register_channel("/other", "protobuf", schema)
    channel = writer.register_channel("/test/sample", "protobuf", schema)
    for index, sample in enumerate(samples):
        if noise:
            writer.add_message(other, index * 10**6, b"anything", index * 10**6)
        data = kind_of_message(**{name: sample[name] for name in kinds if name in sample}).SerializeToString()
        writer.add_message(channel, index * 10**6, data, index * 10**6)
    writer.finish()
    return stream.getvalue()


DOUBLE, FLOAT, TEXT = 1, 2, 9
MINIMAL = dict.fromkeys(("time_s", "arm_deg", "pressure1_mpa", "pressure2_mpa", "command_deg"), DOUBLE)


@pytest.mark.parametrize("syntax", ["proto2", "proto3"])
def test_protobuf_of_another_logger(tmp_path: Path, syntax: str) -> None:
    columns = make_columns(samples=200)
    kinds = MINIMAL | {"phase": FLOAT, "dither_v": DOUBLE, "feedforward_deg": DOUBLE}
    (tmp_path / "a.mcap").write_bytes(protobuf_file(rows(columns), syntax, kinds, reverse=True, noise=True))
    log = read_log(tmp_path / "a.mcap")
    for name in kinds:
        if syntax == "proto3" and name == "feedforward_deg":
            assert name not in log.columns  # zero throughout: proto3 writes nothing, so it counts as absent
        else:
            np.testing.assert_array_equal(log.columns[name], columns[name])


def test_proto3_required_zeros_are_zeros(tmp_path: Path) -> None:
    columns = make_columns(samples=100)
    columns["arm_deg"] = np.zeros(100)
    (tmp_path / "a.mcap").write_bytes(protobuf_file(rows(columns), "proto3", MINIMAL))
    assert (read_log(tmp_path / "a.mcap").columns["arm_deg"] == 0).all()


def test_fast_and_general_path_agree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_log(tmp_path / "a.mcap", make_log(samples=700))
    fast = read_log(tmp_path / "a.mcap")
    monkeypatch.setattr(layout, "decode", lambda *_: None)
    general = read_log(tmp_path / "a.mcap")
    assert list(fast.columns) == list(general.columns)
    for name in fast.columns:
        np.testing.assert_array_equal(fast.columns[name], general.columns[name])


def without(name: str) -> Callable[[list[dict[str, Any]]], Any]:
    return lambda samples: [sample.pop(name) for sample in samples]


def put(index: int, name: str, value: Any) -> Callable[[list[dict[str, Any]]], Any]:
    return lambda samples: samples[index].update({name: value})


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (without("arm_deg"), "required field 'arm_deg' is missing"),
        (lambda samples: samples[9].pop("arm_deg"), "required field 'arm_deg' is missing in 1 of 100 .* at sample 9"),
        (lambda samples: [without(name)(samples) for name in ("pump_deg", "command_deg")], "neither 'pump_deg' nor"),
        (put(5, "arm_deg", float("nan")), r"'arm_deg' is nan at sample 5 \(time 0.005 s\)"),
        (put(5, "dither_v", float("inf")), "'dither_v' is inf at sample 5"),
        (put(5, "dither_v", None), "'dither_v' is nan at sample 5"),
        (put(5, "pressure1_mpa", "0.3"), "'pressure1_mpa' is no number at sample 5: '0.3'"),
        (put(5, "pressure1_mpa", True), "'pressure1_mpa' is no number at sample 5"),
        (put(5, "pressure1_mpa", 10**400), "'pressure1_mpa' holds a number that is too large"),
        (put(50, "time_s", 0.049), "time does not increase at sample 50: 0.049 s, then 0.049 s"),
        (
            lambda samples: samples.__delitem__(slice(40, 43)),
            r"gap of 4 ms after sample 39 \(time 0.039 s\); 3 samples",
        ),
        (lambda samples: samples.__delitem__(slice(0, None, 2)), "wrong rate, samples are 2 ms apart"),
        (put(5, "phase", 7), r"phase 7 at sample 5 .*allowed: 0 preload"),
        (lambda samples: [sample.update(phase=1) for sample in samples], "no sample of the command phase"),
        (lambda samples: samples.clear(), "holds no messages on /test/sample"),
        (lambda samples: samples.__setitem__(5, b"{broken"), "the message of sample 5 is not JSON"),
        (lambda samples: samples.__setitem__(5, b"[1, 2]"), "the message of sample 5 is no JSON object"),
        (lambda samples: samples.__setitem__(5, b"[" * 60000), "the message of sample 5 is not JSON"),
        (lambda samples: samples.__setitem__(5, b" " * 70000), "message 5 is too large for a sample"),
    ],
)
def test_bad_samples_have_one_clear_message(tmp_path: Path, spoil: Callable[[Any], Any], message: str) -> None:
    samples: list[Any] = rows(make_columns(samples=100))
    spoil(samples)
    path = tmp_path / "bad.mcap"
    path.write_bytes(json_file(samples))
    with pytest.raises(UsageError, match=message) as caught:
        read_log(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ") and "\n" not in text


def test_slow_drift_of_the_rate(tmp_path: Path) -> None:
    columns = make_columns(samples=100)
    columns["time_s"] = columns["time_s"] * 1.02
    with pytest.raises(UsageError, match="wrong rate"):
        read_log(write_json(tmp_path / "a.mcap", columns))
    columns["time_s"] = columns["time_s"] / 1.02 * 1.005
    assert read_log(write_json(tmp_path / "a.mcap", columns)).samples == 100


def test_an_optional_field_with_holes_is_left_out(tmp_path: Path) -> None:
    samples = rows(make_columns(samples=30))
    del samples[3]["reference_deg"]
    (tmp_path / "a.mcap").write_bytes(json_file(samples))
    assert "reference_deg" not in read_log(tmp_path / "a.mcap").columns


def test_bad_files_have_one_clear_message(tmp_path: Path) -> None:
    write_log(tmp_path / "good.mcap", make_log(samples=1200))
    good = (tmp_path / "good.mcap").read_bytes()
    flipped = bytearray(good)
    flipped[good.index(b"zstd") + 2000] ^= 4
    in_metadata = bytearray(good)
    in_metadata[good.index(b"bench")] ^= 1
    in_attachment = bytearray(good)
    in_attachment[good.index(b"pump: pump2")] ^= 1
    in_summary = bytearray(good)
    in_summary[good.rindex(b"hjcamp.test")] ^= 1
    short = rows(make_columns(samples=20))
    with_text: list[dict[str, Any]] = [sample | {"dither_v": "much"} for sample in short]
    cases: list[tuple[bytes, str]] = [
        (b"", "the file is empty"),
        (b"time_s,arm_deg\n0,0\n", "is not an MCAP file"),
        (good[:5000], "truncated or was never finished; .*hjcamp log recover"),
        (good[:-1], "truncated or was never finished; .*hjcamp log recover"),
        (good[:8] + good[-8:], "truncated or was never finished"),
        (bytes(flipped), "chunk .*hjcamp log recover"),
        (bytes(in_metadata), "wrong CRC of the data section; .*hjcamp log recover"),
        (bytes(in_attachment), "wrong CRC in attachment 'config.yaml'"),
        (bytes(in_summary), "wrong CRC of the summary"),
        (good[:3000] + good[-3000:], "longer than what holds it|chunk|record"),
        (json_file(short, topics=("/test/sampel",)), r"no topic /test/sample \(nearest: /test/sampel\)"),
        (json_file(short, topics=("/test/sample", "/test/sample")), "2 channels on /test/sample"),
        (json_file(short, encoding="cdr"), "messages in 'cdr'; protobuf and json can be read"),
        (json_file(short, encoding="protobuf"), "protobuf messages need a protobuf schema"),
        (protobuf_file(with_text, "proto2", MINIMAL | {"dither_v": TEXT}), "'dither_v' of the protobuf schema is not"),
    ]
    for content, message in cases:
        path = tmp_path / "bad.mcap"
        path.write_bytes(content)
        with pytest.raises(UsageError, match=message) as caught:
            read_log(path)
        assert str(path) in str(caught.value) and "\n" not in str(caught.value)
    with pytest.raises(UsageError, match="no such file"):
        read_log(tmp_path / "nothing.mcap")
    with pytest.raises(UsageError, match="is not a file"):
        read_log(tmp_path)


def test_a_wrong_crc_alone_is_seen_only_when_asked(tmp_path: Path) -> None:
    content = bytearray(json_file(rows(make_columns(samples=100)), compression=CompressionType.NONE))
    place = content.index(b'"arm_deg": ') + 11
    content[place : place + 1] = b"7"
    (tmp_path / "a.mcap").write_bytes(content)
    with pytest.raises(UsageError, match="wrong CRC in the chunk at byte"):
        read_log(tmp_path / "a.mcap")
    assert read_log(tmp_path / "a.mcap", validate_crcs=False).samples == 100


def test_the_command_phase_and_the_condition() -> None:
    log = make_log(samples=300, before=100)
    assert log.samples == 300 and log.duration == pytest.approx(0.3)
    assert log.command_phase["time_s"][0] == 0 and len(log.command_phase["arm_deg"]) == 200
    without_phase = TestLog({name: values for name, values in log.columns.items() if name != "phase"})
    assert len(without_phase.command_phase["time_s"]) == 300
    assert log.condition_key == "ramp"
    choices = {"trajectory": "ramp_pos", "controller": "pid", "repetition": "1"}
    keys = {TestLog({}, choices | {"repetition": str(number)}).condition_key for number in range(3)}
    assert keys == {"trajectory=ramp_pos controller=pid"}
    assert TestLog({}, {}, path=Path("a/one.mcap")).condition_key != TestLog({}, {}, path=Path("two.mcap")).condition_key
