"""Logs of any plant: fields from its declarations, any period, more than fifteen fields, refusals of one message."""

from __future__ import annotations

import io
import json
import re
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

from hjcamp import cli
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant
from hjcamp.model.language.field_table import fields_of
from hjcamp.records.log import TestLog
from hjcamp.records.mcap import layout
from hjcamp.records.plausible import findings, without_small_tests
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log, verify_log
from hjcamp.records.write import CHUNK_BYTES, LogWriter, write_log

MEASURED = "".join(f'    gauge{number}_v = Measured("gauge", of="lower", required={number == 0})\n' for number in range(20))
PLAUSIBLE = 'Measured("gauge", of="lower", plausible=(0.0, 10.0))'
PERIODS = {"axis": 1e-3, "tanks": 4.0, "many": 0.25}


@pytest.fixture
def plants(folder: Path) -> Path:
    """Return the user's folder with a third plant, whose logs have 45 fields."""
    text = (folder / "plants" / "tanks.py").read_text()
    measured = '    level_v = Measured("gauge", of="lower")\n'
    assert measured in text
    (folder / "plants" / "many.py").write_text(text.replace(measured, MEASURED).replace("Tanks", "Many"))
    return folder


def metadata_of(plant: str) -> dict[str, str]:
    return {"plant": plant, "period_s": repr(PERIODS[plant]), "condition": "step"}


def log_of(plant: str, samples: int = 300) -> TestLog:
    """Return a log of a plant with all its fields but phase."""
    generator = np.random.default_rng(3)
    names = [name for name in fields_of(find_plant(plant)).names if name not in ("time_s", "phase")]
    columns = {"time_s": np.arange(samples) * PERIODS[plant]}
    columns |= {name: 2.0 + np.sin(np.arange(samples) / 30.0) + generator.normal(0.0, 1e-3, samples) for name in names}
    columns |= {name: 0.1 * columns[name] for name in names if name.endswith("position_m")}  # as its plant's file says
    return TestLog(columns, metadata_of(plant))


def test_the_fields_are_what_is_measured_and_given(plants: Path) -> None:
    axis = fields_of(find_plant("axis"))
    assert axis.names == ("time_s", "phase", "reference_position_m", "position_m", "voltage_v")
    assert axis.required == ("time_s", "position_m", "voltage_v")
    assert [field.unit for field in axis.fields] == ["s", "1", "m", "m", "V"]
    assert fields_of(find_plant("tanks")).required == ("time_s", "level_v", "pump_v")
    assert len(fields_of(find_plant("many")).names) == 43
    assert [fields_of(find_plant("pump_joint")).number(name) for name in ("time_s", "arm_deg", "dither_v")] == [
        1,
        4,
        11,
    ]


def test_an_input_may_be_wanted_measured_or_absent(plants: Path) -> None:
    path = plants / "plants" / "axis.py"
    more = '    wanted = Input("m", field="reference_position_m")\n    extra = Input("N", required=False)\n    gain ='
    path.write_text(path.read_text().replace("    gain =", more, 1))
    table = fields_of(find_plant("axis"))
    assert table.names == ("time_s", "phase", "reference_position_m", "position_m", "voltage_v", "extra_n")
    assert "extra_n" not in table.required
    path.write_text(path.read_text().replace('Input("N", required=False)', 'Input("V", field="voltage_v")'))
    with pytest.raises(UsageError, match="two fields of its logs are called 'voltage_v'"):
        fields_of(find_plant("axis"))


@pytest.mark.parametrize("plant", PERIODS)
def test_what_was_written_is_read(plants: Path, plant: str) -> None:
    log = log_of(plant)
    write_log(plants / "a.mcap", log)
    back = read_log(plants / "a.mcap")
    assert list(back.columns) == list(log.columns) and back.metadata == log.metadata
    for name, values in log.columns.items():
        np.testing.assert_array_equal(back.columns[name], values)
    assert back.period == PERIODS[plant] and back.duration == pytest.approx(300 * PERIODS[plant])
    found = verify_log(plants / "a.mcap")
    assert found.whole and not found.findings and not found.problems and found.plant == plant


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_fields_of_a_plant_come_back_as_they_were(plants: Path, data: st.DataObject) -> None:
    table = fields_of(find_plant("many"))
    optional = [name for name in table.names if name not in (*table.required, "phase")]
    names = [*table.required[1:], *data.draw(st.lists(st.sampled_from(optional), unique=True))]
    samples = data.draw(st.integers(2, 30))
    period = data.draw(st.sampled_from([1e-5, 1e-3, 0.25, 4.0, 3600.0]))
    numbers = st.floats(allow_nan=False, allow_infinity=False)
    columns = {"time_s": np.arange(samples) * period}
    columns |= {name: np.array(data.draw(st.lists(numbers, min_size=samples, max_size=samples))) for name in names}
    write_log(plants / "a.mcap", TestLog(columns, {"plant": "many", "period_s": repr(period)}))
    back = read_log(plants / "a.mcap")
    assert list(back.columns) == [name for name in table.names if name in columns]
    for name, values in columns.items():
        np.testing.assert_array_equal(back.columns[name], values)


def test_both_ways_to_decode_agree_and_protobuf_reads_long_tags(plants: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    log = log_of("many", samples=20)
    write_log(plants / "a.mcap", log)
    taken: list[object] = []
    decode = layout.decode
    monkeypatch.setattr(layout, "decode", lambda *given: taken.append(decode(*given)) or taken[-1])
    fast = read_log(plants / "a.mcap")
    assert taken and all(one is not None for one in taken), "the fixed layout was not recognised"
    monkeypatch.setattr(layout, "decode", lambda *_: None)
    general = read_log(plants / "a.mcap")
    for name in log.columns:
        np.testing.assert_array_equal(fast.columns[name], general.columns[name])
    schema, _, _ = next(iter(reader := make_reader(io.BytesIO(Path("a.mcap").read_bytes())).iter_messages()))
    pool = descriptor_pool.DescriptorPool()
    assert schema is not None
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
        pool.Add(file)
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName("hjcamp.Sample"))
    for index, (_, _, record) in enumerate(reader, start=1):
        sample = kind.FromString(record.data)
        assert all(getattr(sample, name) == values[index] for name, values in log.columns.items())


def test_a_tag_is_what_protobuf_writes() -> None:
    for number, written in ((1, b"\x09"), (15, b"\x79"), (16, b"\x81\x01"), (43, b"\xd9\x02"), (2047, b"\xf9\x7f")):
        assert struct.pack("<H", layout.tag(number))[: len(written)] == written


def test_a_growing_log_of_slow_samples_is_on_the_disk_at_once(plants: Path) -> None:
    log = log_of("tanks", samples=7)
    writer = LogWriter(plants / "a.mcap", tuple(log.columns), log.metadata)
    for index in range(7):
        writer.append({name: float(values[index]) for name, values in log.columns.items()})
        saved = recover_log(writer.part, plants / f"saved_{index}.mcap")
        assert saved.kept == index + 1 and saved.lost == 0
    writer.abort()
    assert read_log(plants / "saved_6.mcap").duration == 28.0


def test_lost_samples_are_counted_in_periods(plants: Path) -> None:
    log = log_of("tanks", samples=9000)
    write_log(plants / "a.mcap", log)
    data = (plants / "a.mcap").read_bytes()
    (plants / "b.mcap").write_bytes(data[: len(data) // 2])
    saved = recover_log(plants / "b.mcap", plants / "c.mcap")
    in_chunk = CHUNK_BYTES // layout.record_dtype((1, 3, 4, 5)).itemsize
    assert saved.kept % in_chunk == 0 and saved.kept > 0 and saved.lost == in_chunk
    assert read_log(plants / "c.mcap").metadata["plant"] == "tanks"


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"plant": "axes"}, "unknown plant 'axes' in .*did you mean 'axis'"),
        ({"period_s": "fast"}, "period_s of its metadata is 'fast'; a number above 0"),
        ({"period_s": "nan"}, "period_s of its metadata is 'nan'"),
        ({"period_s": "0.002"}, "samples are 1 ms apart; by period_s of its metadata it has one each 2 ms"),
        ({"plant": "tanks"}, "required field 'level_v' is missing"),
    ],
)
def test_metadata_that_cannot_be_are_refused(plants: Path, change: dict[str, str], told: str) -> None:
    log = log_of("axis")
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    writer.add_metadata("hjcamp.test", log.metadata | change)
    channel = writer.register_channel("/test/sample", "json", writer.register_schema("hjcamp.Sample", "jsonschema", b"{}"))
    for index in range(log.samples):
        sample = {name: float(values[index]) for name, values in log.columns.items()}
        writer.add_message(channel, index * 10**6, json.dumps(sample).encode(), index * 10**6)
    writer.finish()
    (plants / "a.mcap").write_bytes(stream.getvalue())
    with pytest.raises(UsageError, match=told) as caught:
        read_log(plants / "a.mcap")
    assert "\n" not in str(caught.value) and "a.mcap" in str(caught.value)
    assert not verify_log(plants / "a.mcap").whole
    if change != {"period_s": "0.002"}:
        with pytest.raises(UsageError, match=told):
            recover_log(plants / "a.mcap", plants / "b.mcap")
        assert not (plants / "b.mcap").exists()


def test_a_plant_says_what_is_plausible(plants: Path) -> None:
    assert findings(log_of("tanks")) == []
    path = plants / "plants" / "tanks.py"
    path.write_text(path.read_text().replace('Measured("gauge", of="lower")', PLAUSIBLE))
    log = log_of("tanks")
    log.columns["level_v"] = log.columns["level_v"] * 1e3
    [found] = findings(log)
    assert found.refused and "a sound log stays within 0 and 10 V; looks like mV" in found.text
    log.columns["level_v"] = np.full(300, 4.0)
    [found] = findings(log)
    assert found.refused and "'level_v' is 4 V in all 300 samples" in found.text


def test_a_counting_sensor_may_stand_still(plants: Path) -> None:
    log = log_of("axis")
    log.columns["position_m"] = np.zeros(300)
    assert [one.refused for one in findings(log)] == [True]
    path = plants / "plants" / "axis.py"
    path.write_text(path.read_text().replace('of="position")', 'of="position", counts=1e-6)', 1))
    assert findings(log) == []


def test_tests_of_a_plant_are_told_apart_by_their_metadata(plants: Path) -> None:
    light, heavy = ({"plant": "axis", "mass_kg": mass, "repetition": "1"} for mass in ("95", "120"))
    assert TestLog({}, light).condition_key != TestLog({}, heavy).condition_key
    assert TestLog({}, light).condition_key == TestLog({}, light | {"repetition": "2"}).condition_key


def test_info_and_verify_show_the_fields_of_the_plant(plants: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_log(plants / "logs" / "a.mcap", log_of("tanks"))
    assert cli.run(["log", "info", "logs"]) == 0
    told = capsys.readouterr().out
    assert "plant tanks, one sample each 4 s" in told and "reference_level_v level_v pump_v" in told
    assert "300 samples, 1200.000 s, whole" in told
    assert cli.run(["log", "verify", "logs"]) == 0
    assert "1 log of plant tanks, one sample each 4 s: time_s reference_level_v" in capsys.readouterr().out


COMMANDS = (
    ["compare", "logs"],
    ["diagnose", "logs"],
    ["add", "leakage", "logs", "--as", "more"],
    ["next", "logs"],
    ["calibrate", "logs", "--as", "mine"],
)


@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: words[0])
def test_an_analysis_refuses_logs_of_several_plants(plants: Path, words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    write_log(plants / "logs" / "a.mcap", log_of("axis"))
    write_log(plants / "logs" / "b.mcap", log_of("tanks"))
    before = sorted(plants.rglob("*"))
    assert cli.run(words) == 2
    told = capsys.readouterr().err
    mixed = "logs of one plant given to another: logs/a.mcap is of plant axis, logs/b.mcap of plant tanks"
    assert mixed in told or "plant axis has no menu of tests" in told
    assert sorted(plants.rglob("*")) == before, "something was written"


def test_logs_of_a_plant_that_is_not_here_are_named(plants: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_log(plants / "logs" / "a.mcap", log_of("axis"))
    (plants / "plants" / "axis.py").unlink()
    assert cli.run(["compare", "logs"]) == 2
    assert "unknown plant 'axis' in logs" in capsys.readouterr().err
    assert cli.run(["log", "info", "logs"]) == 0
    assert "problem      unknown plant 'axis'" in capsys.readouterr().out


def test_where_no_plant_of_ones_own_stands_it_is_said_where_they_are_looked_for(
    plants: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write_log(plants / "logs" / "a.mcap", log_of("axis"))
    (plants / "elsewhere").mkdir()
    monkeypatch.chdir(plants / "elsewhere")
    assert cli.run(["compare", "../logs"]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "unknown plant 'axis'" in said and "Your own are looked for in ./plants, where none is" in said


def test_an_analysis_says_which_periods_it_knows(plants: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = [name for name in fields_of(find_plant("pump_joint")).names if name not in ("time_s", "phase")]
    columns = {name: 0.3 + np.random.default_rng(6).normal(0.0, 1e-3, 200) for name in names}
    columns["time_s"] = np.arange(200) * 0.004
    write_log(plants / "logs" / "a.mcap", TestLog(columns, {"period_s": "0.004"}))
    assert read_log(plants / "logs" / "a.mcap").duration == pytest.approx(0.8)
    assert cli.run(["compare", "logs"]) == 2
    assert "a.mcap: one sample each 4 ms; the diagnosis knows only one each 1 ms so far" in capsys.readouterr().err


def test_a_column_far_from_what_is_typical_may_be_in_another_unit(plants: Path) -> None:
    log = log_of("tanks")
    assert findings(log) == []
    large = "goes to 3000 V, 600 times its typical size.*it is 1000 times too large, as mV read as V or V as kV would be"
    for factor, told in ((1e3, large), (30.0, ""), (1e-3, "as kV read as V or V as mV would be")):
        wrong = TestLog({**log.columns, "level_v": log.columns["level_v"] * factor}, log.metadata)
        found = [one for one in findings(wrong) if not one.refused]
        assert bool(found) == bool(told)
        assert not found or re.search(told, found[0].text), found[0].text
    wrong = [TestLog({**log.columns, "level_v": log.columns["level_v"] * factor}, log.metadata) for factor in (1e-3, 1.0)]
    assert [len(one) for one in without_small_tests([findings(log) for log in (wrong[0], wrong[0])])] == [1, 1]
    assert without_small_tests([findings(log) for log in wrong]) == [[], []]
    # its inputs are said to be about 1 by no file: that is no reason to doubt
    axis = log_of("axis")
    assert findings(TestLog({**axis.columns, "voltage_v": axis.columns["voltage_v"] * 1e3}, axis.metadata)) == []
