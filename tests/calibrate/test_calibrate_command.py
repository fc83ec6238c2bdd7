"""hjcamp calibrate from end to end: JSON logs of another logger, clear errors, files that run accepts by name."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest
import yaml
from identification_logs import compliance_log, friction_log, leakage_log, step_log
from mcap.writer import CompressionType, Writer

from hjcamp import cli
from hjcamp.analyses.data import Data
from hjcamp.configuration.composer import Composer
from hjcamp.configuration.setups import configuration_for
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.analyses.calibrating import identify_joint
from hjcamp.plants.pump_joint.calibrate.configuration_file import model_text, write_configuration
from hjcamp.plants.pump_joint.calibrate.estimate import Estimate, Finding
from hjcamp.plants.pump_joint.calibrate.identify import Calibration, identify
from hjcamp.plants.pump_joint.calibrate.kinds import kind_of
from hjcamp.plants.pump_joint.hardware import plant_parameters
from hjcamp.records.log import TestLog
from hjcamp.records.write import write_log

REQUIRED = ("time_s", "arm_deg", "pressure1_mpa", "pressure2_mpa")
JSON_SAMPLES = 6000  # a log of 15 s takes seconds to write this way
SPEEDS = (0.0025, 0.01, 0.03, 0.06)


def rig_logs(repetitions: int = 2) -> dict[str, list[TestLog]]:
    """Return the logs of all four identifications."""
    seeds = range(repetitions)
    return {
        "step": [step_log(seed=seed) for seed in seeds],
        "compliance": [compliance_log(seed=seed) for seed in seeds],
        "leakage": [leakage_log(seed=seed) for seed in seeds],
        "friction": [friction_log(speed, seed=seed) for speed in SPEEDS for seed in seeds],
    }


def write_json(path: Path, log: TestLog, metadata: dict[str, str]) -> None:
    """Write a log as another logger does: JSON messages, the required fields and one of the pump's."""
    stream = io.BytesIO()
    writer = Writer(stream, compression=CompressionType.ZSTD)
    writer.start(profile="", library="another logger")
    schema = writer.register_schema("hjcamp.Sample", "jsonschema", json.dumps({"type": "object"}).encode())
    channel = writer.register_channel("/test/sample", "json", schema)
    writer.add_metadata("hjcamp.test", metadata)
    fields = [*REQUIRED, "pump_deg" if "pump_deg" in log.columns else "command_deg"]
    for index, values in enumerate(zip(*(log.columns[name].tolist() for name in fields), strict=True)):
        time = 1_760_000_000_000_000_000 + index * 1_000_000
        content = json.dumps(dict(zip(fields, values, strict=True))).encode()
        writer.add_message(channel, time, content, time, index)
    writer.finish()
    path.write_bytes(stream.getvalue())


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("HJCAMP_CONF", raising=False)
    return tmp_path


def test_kinds_are_seen_in_the_samples_and_named_by_the_campaign() -> None:
    expected = {"step": "pump_step", "compliance": "compliance", "leakage": "leakage", "friction": "friction"}
    for name, logs in rig_logs(1).items():
        for log in logs:
            assert kind_of(log) == expected[name]
    named = TestLog(compliance_log().columns, {"campaign": "leakage"})
    assert kind_of(named) == "leakage"


def test_json_logs_without_optional_fields_give_a_model_by_name(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (folder / "logs").mkdir()
    for name, logs in rig_logs().items():
        for number, log in enumerate(logs):
            metadata = {"condition": log.metadata.get("condition", name), "repetition": log.metadata["repetition"]}
            first = {field: values[:JSON_SAMPLES] for field, values in log.columns.items()}
            write_json(folder / "logs" / f"{name}_{number}.mcap", TestLog(first), metadata)
    assert cli.run(["calibrate", "logs", "--as", "bench"]) == 0
    out, err = capfd.readouterr()
    assert not err and "conf/model/bench.yaml" in out and "static friction, positive" in out
    page = (folder / "calibration" / "bench.html").read_text()
    for figure in ("4.3.2", "4.3.3 to 4.3.5", "4.4.5", "4.4.6", "4.5.1", "4.5.3, A.1", "4.5.3, A.2"):
        assert f"as Figure {figure}" in page
    model = Composer().model("bench")
    assert model["parameters"]["static_positive"] == pytest.approx(7.2, rel=0.02)
    assert model["parameters"]["line_stiffness"] == pytest.approx(2.57e13, rel=0.01)
    assert set(model["parameters"]) <= set(PumpJoint.parameters)
    assert model["effects"]["leakage"]["threshold"] == pytest.approx(0.59e6, rel=0.01)
    config = Composer().compose(["model=bench", "rig=bench"]).config
    assert config["rig"]["sensors"]["encoder_counts_per_turn"] == 1024
    assert config["rig"]["name"] == "bench" and plant_parameters(config)
    assert cli.run(["calibrate", "logs", "--as", "bench"]) == 2
    assert "--replace" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere", "--as", "bench"], "nowhere"),
        (["logs", "--as", "published"], "choose another name"),
        (["logs", "--as", "a/b"], "cannot be the name"),
        (["logs", "--as", "bench"], "mixed hardware: these logs name 2 choices of pump: pump1, pump2"),
        (["logs", "--as", "bench", "--only", "pump=pump3"], "did you mean"),
        (["logs", "--as", "bench", "--only", "pump"], "KEY=VALUE"),
    ],
)
def test_unusable_calls(folder: Path, capfd: pytest.CaptureFixture[str], arguments: list[str], words: str) -> None:
    for pump in ("pump1", "pump2"):
        log = compliance_log()
        write_log(folder / "logs" / f"{pump}.mcap", TestLog(log.columns, {**log.metadata, "pump": pump}))
    assert cli.run(["calibrate", *arguments]) == 2
    assert words in capfd.readouterr().err
    assert not (folder / "conf").exists()


def test_logs_that_serve_nothing_are_refused() -> None:
    log = friction_log(0.01)
    still = {name: values[:500] * 0.0 for name, values in log.columns.items() if name != "time_s"}
    with pytest.raises(Exception, match="none of 1 log serves an identification"):
        identify([TestLog({"time_s": log.columns["time_s"][:500], **still})], configuration_for)


def test_the_model_says_what_is_certain() -> None:
    found = identify([compliance_log(seed=seed) for seed in range(2)], configuration_for)
    text = model_text("bench", found, {"command": "hjcamp calibrate"})
    content = yaml.safe_load(text)
    assert content["effects"] == {} and content["provenance"]["tests"] == 2
    line = next(line for line in text.splitlines() if "line_stiffness" in line)
    assert "95 %" in line and "published 2.57e+13" in line and "Pa/m^3" in line


@pytest.mark.parametrize(
    ("name", "conditions"),
    [("pump_step", 3), ("compliance", 1), ("leakage", 1), ("friction", 7), ("open_loop_validation", 1)],
)
def test_campaigns_of_chapter_4_can_be_planned(name: str, conditions: int) -> None:
    from hjcamp.campaign.plan.planning import make_plan

    composer = Composer()
    plan = make_plan(composer.compose([f"campaign={name}"]).config, name, [f"campaign={name}"], composer)
    assert len(plan.conditions) == conditions
    assert all(one.config["controller"]["name"] == "open_loop" for one in plan.conditions)


def test_a_value_that_no_command_would_take_is_not_saved(empty_folder: Path) -> None:
    viscous = Estimate("viscous_positive", -3.0, "N*s/m", None, 2, "viscous friction", "N*s/m")
    found = Calibration({}, {"friction": Finding("friction", (viscous,))}, 2)
    reference = Composer().compose([]).config
    with pytest.raises(UsageError, match=r"no model that could be used: model\.parameters\.viscous_positive is -3"):
        write_configuration("bench", found, reference, empty_folder / "conf", {})
    assert not (empty_folder / "conf").exists()


def test_a_refusal_names_what_estimates_the_same_from_whole_tests(folder: Path) -> None:
    write_log(folder / "one.mcap", friction_log(SPEEDS[0], seed=1))
    with pytest.raises(UsageError, match=r"too few speeds.*: hjcamp diagnose one\.mcap estimates them from whole tests"):
        identify_joint(Data([Path("one.mcap")]), "mine", {})
