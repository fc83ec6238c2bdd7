"""``hjcamp run --like LOG``: the tests of a log's condition again, equal byte for byte; and the model of a run as a file."""

from __future__ import annotations

from pathlib import Path

import pytest

from hjcamp import cli
from hjcamp.campaign.plan.like import plan_like
from hjcamp.model.declare.plant import Plant
from hjcamp.records.plan import read_plan
from hjcamp.records.read import read_log
from hjcamp.records.write import write_log

SEGMENTS = "trajectory.segments=[{to_v: 4, in: 0.1, law: linear}, {rest: 0.2}]"
CALL = ["run", "plant=carriage", "controller=given", "trajectory=segments", SEGMENTS, "seed=5", "repetitions=2", "run_dir=one"]


@pytest.fixture
def made(carriage: type[Plant], capsys: pytest.CaptureFixture[str]) -> Path:
    """A log of a run with parameters of its own."""
    assert cli.run([*CALL, "parameters.coulomb=33.0"]) == 0, capsys.readouterr().err
    return next(Path("one/logs").rglob("rep_02.mcap"))


def test_its_tests_are_made_again_byte_for_byte_and_its_model_is_exported(
    made: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["run", f"--like={made}", "run_dir=two"]) == 0, capsys.readouterr().err
    again = Path("two") / made.relative_to("one")
    assert again.read_bytes() == made.read_bytes()
    assert [one.sha256 for one in read_plan(Path("two/plan.json")).conditions] == [
        one.sha256 for one in read_plan(Path("one/plan.json")).conditions
    ]
    assert cli.run(["model", "export", "carriage", "--run", "one"]) == 0, capsys.readouterr().err
    names: dict[str, object] = {}
    exec(Path("carriage.py").read_text(encoding="utf-8"), names)
    assert names["PARAMETERS"]["coulomb"] == 33.0 and names["SOURCE"]["run"] == "one"  # type: ignore[index]


def test_what_cannot_be_made_again_is_refused(made: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = read_log(made)
    log.attachments["config.yaml"] = log.attachments["config.yaml"].replace(b"33.0", b"34.0")
    write_log("other.mcap", log)
    log.attachments.clear()
    write_log("bare.mcap", log)
    for words, said in (
        (["--like"], "give the log"),
        (["--like", "none.mcap"], "none.mcap"),
        (["--like", "other.mcap"], "is not that which its test was made with"),
        (["--like", "bare.mcap"], "holds no configuration"),
        (["--like", str(made), "seed=6"], "the log says all of the test"),
    ):
        assert cli.run(["run", *words]) == 2
        assert said in capsys.readouterr().err
    assert plan_like(read_log(made), made).seed == 5
