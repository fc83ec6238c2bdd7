"""hjcamp next: before any test, after tests that cannot tell, after tests that have told; and calls that make no sense."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from discrepancy_answers import Call, read_answer
from truth.__main__ import read_campaign
from truth.pump_joint.case import write_case

KEYS = {
    "schema", "verdict", "rivals", "tests", "together", "campaign", "campaign_file", "picture", "seconds",
}  # fmt: skip
FEW = ("procedure.preload_mpa=0.4", "payload=none", "orientation=horizontal")


@pytest.mark.study
def test_before_any_test_the_campaign_runs_as_it_is(call: Call) -> None:
    answer = call("next", *FEW, "--rivals", "leakage", "stribeck_friction", "--tests", "2", "--json", "n.json")
    assert answer.code == 0, answer.err
    found = read_answer(Path("n.json"))
    assert set(found) == KEYS and found["schema"] == "hjcamp.next/1" and found["verdict"] is None
    assert [row["effects"] for row in found["rivals"]] == [["leakage"], ["stribeck_friction"]]
    assert 1 <= len(found["tests"]) <= 2 and all(row["preload_mpa"] == 0.4 for row in found["tests"])
    (pair,) = found["together"]
    assert pair["rivals"] == ["leakage", "stribeck_friction"] and pair["separation"] > 3.0
    assert Path(found["picture"]).read_bytes().startswith(b"\x89PNG")
    campaign = yaml.safe_load(Path(found["campaign_file"]).read_text(encoding="utf-8"))
    assert campaign["name"] == found["campaign"] == "next_1" and campaign["repetitions"] == 3
    assert list(campaign["vary"]["test"]) == [row["condition"] for row in found["tests"]]
    assert "hjcamp run campaign=next_1" in answer.out

    ran = call("run", "campaign=next_1", "run_dir=out", "workers=1")
    assert ran.code == 0, ran.err
    assert len(list(Path("out/logs").rglob("*.mcap"))) == 3 * len(found["tests"])
    again = call("next", *FEW, "--rivals", "leakage,stribeck_friction", "--as", "next_1")
    assert again.code == 2 and "'next_1' exists already" in again.err


@pytest.mark.study
def test_the_proposed_tests_settle_the_verdict(call: Call, leak: Path) -> None:
    first = sorted(leak.glob("sine_0p5hz_mid_r*.mcap"))
    answer = call("next", *first, *FEW, "--effort", "quick", "--as", "more", "--json", "n.json")
    assert answer.code == 0, answer.err
    found = read_answer(Path("n.json"))
    assert found["verdict"] == "cannot_tell" and len(found["rivals"]) >= 2 and found["tests"]
    assert sum(row["posterior"] for row in found["rivals"]) == pytest.approx(1.0)
    asked = read_campaign(Path("campaigns/more.yaml"))
    write_case("more_logs", ["leakage"], "medium", 101, conditions=asked)
    answer = call("diagnose", *first, "more_logs", "--effort", "quick", "--json", "d.json")
    assert answer.code == 0, answer.err
    told = read_answer(Path("d.json"))
    assert (told["verdict"], told["effects"]) == ("effect", ["leakage"])

    answer = call("next", *first, "more_logs", "--effort", "quick", "--json", "n2.json")
    assert answer.code == 0 and "NOTHING TO SEPARATE" in answer.out, answer.err
    settled = read_answer(Path("n2.json"))
    assert set(settled) == KEYS and settled["tests"] == [] and settled["campaign"] is None
    assert [path.name for path in Path("campaigns").iterdir()] == ["more.yaml"]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("next", "nowhere"), "no such file or folder"),
        (("next", "--rivals", "leakge"), "did you mean 'leakage'"),
        (("next", "--rivals", "leakage", "stribeck_frictoin"), "did you mean 'stribeck_friction'"),
        (("next", "--rivals", "leakage,leakage"), "each rival once"),
        (("next", "--rivals", "nothing"), "name an effect"),
        (("next", "--rivals", "leakage", "--tests", "0"), "--tests 0"),
        (("next", "--rivals", "leakage", "--as", "controllers"), "exists already"),
        (("next", "--rivals", "leakage", "--as", "a/b"), "cannot be the name"),
        (("next", "--rivals", "leakage", "pump=pump3"), "pump"),
        (("next", "--rivals", "leakage", "repetitions=3"), "belongs to the run"),
        (("next", "--rivals", "leakage", "procedure.preload_mpa=0.123"), "no test of the menu remains"),
        (("next", "--rivals", "leakage", "--effort", "quik"), "did you mean 'quick'"),
    ],
)
def test_one_clear_message(call: Call, arguments: tuple[str, ...], told: str) -> None:
    answer = call(*arguments)
    assert answer.code == 2
    assert told in answer.err and len(answer.err.strip().splitlines()) == 1
    assert not Path("campaigns").exists() and not Path("next").exists()
