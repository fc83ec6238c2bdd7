"""Logs that are whole and cannot be: wrong units, spikes, sensors that stand still, a configuration that did not run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from log_makers import make_columns, make_log, write_json

from hjcamp import cli
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
from hjcamp.records.elsewhere.importing import import_file
from hjcamp.records.log import TestLog
from hjcamp.records.plausible import findings, refuse_implausible
from hjcamp.records.recover import verify_log
from hjcamp.records.write import write_log

Columns = dict[str, np.ndarray]


def scaled(name: str, factor: float) -> Callable[[Columns], object]:
    """Return what multiplies a column."""
    return lambda columns: columns.update({name: columns[name] * factor})


def still(name: str, value: float) -> Callable[[Columns], object]:
    """Return what holds a column."""
    return lambda columns: columns.update({name: np.full(len(columns[name]), value)})


def noisy(columns: Columns) -> None:
    """Give a log noise of its own, as another test has."""
    columns["pressure1_mpa"] = columns["pressure1_mpa"] + np.random.default_rng(8).normal(0.0, 7e-4, len(columns["time_s"]))


def spoilt(*changes: Callable[[Columns], object], samples: int = 1200) -> TestLog:
    """Return a log that moves by more than 20 deg, with changes."""
    log = make_log(samples)
    for change in changes:
        change(log.columns)
    return log


def test_a_sound_log_has_no_findings() -> None:
    assert findings(spoilt()) == []


@pytest.mark.parametrize(
    ("change", "field", "refused", "told"),
    [
        (scaled("pressure1_mpa", 1e6), "pressure1_mpa", True, "looks like Pa: 1e+06 times too large"),
        (scaled("pressure1_mpa", 1e3), "pressure1_mpa", True, "looks like kPa: 1000 times too large"),
        (scaled("pressure2_mpa", 10.0), "pressure2_mpa", True, "looks like bar: 10 times too large"),
        (scaled("pressure1_mpa", 1e12), "pressure1_mpa", True, "looks like another quantity"),
        (scaled("reference_deg", 100.0), "reference_deg", False, "a sound log stays within -360 and 360 deg"),
        (scaled("dither_v", 1e3), "dither_v", False, "looks like mV: 1000 times too large"),
        (scaled("arm_deg", np.pi / 180), "arm_deg", False, "looks like rad: 57.3 times too small"),
        (scaled("arm_deg", 1 / 360), "arm_deg", False, "looks like turn: 360 times too small"),
        (scaled("pump_deg", np.pi / 180), "pump_deg", False, "looks like rad: 57.3 times too small"),
        (scaled("pump_deg", 1 / 360), "pump_deg", False, "360 times too small"),
        (lambda c: c["pressure1_mpa"].__setitem__(700, 1e300), "pressure1_mpa", True, "1 single sample is off, 1e+300"),
        (
            lambda c: c["arm_deg"].__setitem__([5, 6], -1e4),
            "arm_deg",
            True,
            "2 samples are off, -1e+04 deg at sample 5",
        ),
        (
            lambda c: c["pressure1_mpa"].__setitem__(slice(700, 720), 2.4),
            "pressure1_mpa",
            False,
            "reaches 2.4 MPa; a sound log",
        ),
        (lambda c: c["pressure1_mpa"].__setitem__(slice(700, 720), 24.0), "pressure1_mpa", True, "reaches 24 MPa; a sound log"),
        (still("pressure1_mpa", 0.0), "pressure1_mpa", True, "in all 1200 samples; a sensor has noise"),
        (still("arm_deg", 12.0), "arm_deg", False, "never changes although 'pump_deg' moves"),
    ],
)
def test_what_cannot_be_is_named_with_its_cause(
    change: Callable[[Columns], object], field: str, refused: bool, told: str
) -> None:
    found = findings(spoilt(change))
    assert [(one.field, one.refused) for one in found] == [(field, refused)]
    assert told in found[0].text and f"'{field}'" in found[0].text and "\n" not in found[0].text


def test_a_blocked_joint_stands_still() -> None:
    log = spoilt(still("arm_deg", 0.0))
    log.attachments["config.yaml"] = b"joint: {name: blocked, bore_mm: 0.001}\n"
    assert findings(log) == []
    small = spoilt(still("arm_deg", 0.0), scaled("pump_deg", 0.05), scaled("command_deg", 0.05))
    assert findings(small) == [], "a pump that hardly moves moves no arm"


def test_a_flicker_of_the_encoder_is_no_wrong_unit() -> None:
    log = spoilt()
    log.columns["arm_deg"] = np.where(np.arange(1200) % 3 == 0, 0.3515625, 0.0)
    assert findings(log) == []


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (b"pump: {bore_mm: .nan}\n", "pump.bore_mm is not a finite number"),
        (b"gains: [1.0, .inf]\n", "gains.1 is not a finite number"),
        (b"a: &a {b: .nan}\nd: *a\n", "a.b is not a finite number"),
    ],
)
def test_an_attached_configuration_that_cannot_have_run(text: bytes, told: str) -> None:
    log = spoilt()
    log.attachments["config.yaml"] = text
    found = findings(log)
    assert len(found) == 1 and told in found[0].text and not found[0].refused


@pytest.mark.parametrize("text", [b"", b"- 1\n", b"\xff\xfe", b"a: [", b"name: bench\n"])
def test_an_attachment_of_another_kind_says_nothing(text: bytes) -> None:
    log = spoilt()
    log.attachments["config.yaml"] = text
    assert findings(log) == []


def test_the_ranges_are_those_of_the_plant(monkeypatch: pytest.MonkeyPatch) -> None:
    narrow = tuple(replace(one, plausible=(-0.1, 0.1)) for one in PumpJoint.channels)
    monkeypatch.setattr(PumpJoint, "channels", narrow)
    assert {one.field for one in findings(spoilt())} >= {"arm_deg", "pressure1_mpa"} - {"pressure1_mpa"}
    monkeypatch.setattr(PumpJoint, "channels", tuple(replace(one, plausible=(-1e9, 1e9)) for one in narrow))
    assert findings(spoilt(scaled("pressure1_mpa", 1e3))) == []


def test_what_must_be_refused_comes_first_and_is_counted() -> None:
    log = spoilt(scaled("dither_v", 1e3), scaled("pressure1_mpa", 1e6), scaled("pressure2_mpa", 1e6))
    assert [one.refused for one in findings(log)] == [True, True, False]
    with pytest.raises(UsageError, match=r"^x\.mcap: 'pressure1_mpa' reaches .*\(and 1 more of its columns\)$"):
        refuse_implausible(log, "x.mcap")


def test_verify_names_errors_and_warnings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_log(tmp_path / "good.mcap", spoilt())
    other = replace(spoilt(scaled("arm_deg", np.pi / 180), noisy), metadata={"condition": "other"})
    write_log(tmp_path / "rad.mcap", other)
    assert cli.run(["log", "verify", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "rad.mcap: warning: 'arm_deg' moves" in said
    assert "2 logs, 2 whole, 0 not; 0 with what cannot be, 1 with warnings" in said
    write_log(tmp_path / "pa.mcap", replace(spoilt(scaled("pressure1_mpa", 1e6)), metadata={"condition": "pa"}))
    found = verify_log(tmp_path / "pa.mcap")
    assert found.refused and found.whole
    assert cli.run(["log", "verify", str(tmp_path)]) == 1
    said = capsys.readouterr()
    assert "pa.mcap: error: 'pressure1_mpa' reaches" in said.out and "what cannot be is in 1 of 3 logs" in said.err


def test_analyses_refuse_errors_and_say_warnings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number in (1, 2):
        write_log(tmp_path / f"rep_{number}.mcap", spoilt(scaled("arm_deg", np.pi / 180), *[noisy] * (number - 1)))
    evidence_of([tmp_path])
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "looks like rad" in said and "(and so in 1 more log)" in said
    write_log(tmp_path / "rep_3.mcap", spoilt(scaled("pressure1_mpa", 1e6)))
    with pytest.raises(UsageError, match=r"rep_3.mcap: 'pressure1_mpa' reaches .* looks like Pa"):
        evidence_of([tmp_path])


def test_milliseconds_in_the_time(tmp_path: Path) -> None:
    columns = make_columns(600)
    columns["time_s"] = columns["time_s"] * 1e3
    problems = verify_log(write_json(tmp_path / "ms.mcap", columns)).problems
    assert "looks like ms in time_s: 1000 times too large" in problems[0]


FIELDS = {"time_s": "t", "arm_deg": "a", "pressure1_mpa": "p", "pressure2_mpa": "q", "pump_deg": "x"}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        # The position of an axis, in mm, taken for a pressure.
        ({"pressure1_mpa": {"column": "mm"}}, "'pressure1_mpa' reaches 200 MPa; .*looks like"),
        ({"pressure1_mpa": {"column": "p", "scale": 1e6}}, "looks like Pa: 1e\\+06 times too large"),
        ({"time_s": {"column": "t", "unit": "ms"}}, "1e\\+06 rows a second, .* s read as ms are 1000 times too short"),
        ({"arm_deg": {"column": "a", "unit": "m"}}, "'m' is a unit of a length, and 'arm_deg' is an angle"),
        (
            {"pressure1_mpa": {"column": "p", "unit": "N"}},
            "'N' is a unit of a force, and 'pressure1_mpa' is a pressure",
        ),
        ({"position_m": "mm"}, "unknown field 'position_m' in .*plant pump_joint"),
    ],
)
def test_an_import_refuses_what_is_of_another_plant_or_unit(tmp_path: Path, change: dict[str, object], told: str) -> None:
    columns = make_columns(1200)
    table = {short: columns[name] for name, short in FIELDS.items()} | {"mm": np.linspace(0.0, 200.0, 1200)}
    rows = np.column_stack(list(table.values()))
    (tmp_path / "t.csv").write_text("\n".join([",".join(table), *(",".join(map(repr, row.tolist())) for row in rows)]))
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"fields": FIELDS | change}))
    with pytest.raises(UsageError, match=told) as caught:
        import_file(tmp_path / "t.csv", tmp_path / "m.yaml", tmp_path / "out.mcap")
    assert "\n" not in str(caught.value) and not (tmp_path / "out.mcap").exists()
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"fields": FIELDS}))
    import_file(tmp_path / "t.csv", tmp_path / "m.yaml", tmp_path / "out.mcap")


def test_an_import_refuses_hardware_that_nobody_describes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("t.csv").write_text("t\n0\n")
    Path("m.yaml").write_text(yaml.safe_dump({"fields": FIELDS, "metadata": {"pump": "pump9"}}))
    assert cli.run(["import", "t.csv", "--map", "m.yaml"]) == 2
    assert not list(Path().glob("*.mcap*"))
