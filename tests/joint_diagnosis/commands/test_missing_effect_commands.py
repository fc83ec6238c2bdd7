"""compare, diagnose, add, compare from end to end on a plant that shares no code with the model."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from discrepancy_answers import Call, read_answer

from hjcamp.records.read import read_log
from hjcamp.records.write import write_log

KEYS = {
    "schema", "verdict", "effects", "drivers", "p_value", "candidates", "error", "calibration", "where",
    "confounded", "lacking", "minimum_detectable", "seconds", "unknowns",
    "plant", "law_left", "confidence_set", "floor", "worst", "rests_on",
}  # fmt: skip
BOXES = {"joint", "lines", "pump"}


def check_rows(rows: list[dict[str, object]]) -> None:
    """Check the rows of ``where``."""
    assert all(set(row) == {"subsystem", "variable", "bin", "share", "z"} for row in rows)
    shares = [row["share"] for row in rows]
    assert shares == sorted(shares, reverse=True)  # type: ignore[type-var]
    assert all(row["subsystem"] in BOXES for row in rows)


def check_leak(found: dict[str, Any]) -> None:
    """Check the answer of a diagnosis of tests with a leak."""
    assert set(found) == KEYS and found["schema"] == "hjcamp.diagnosis/2" and found["plant"] == "pump_joint"
    assert (found["verdict"], found["effects"]) == ("effect", ["leakage"])
    best = found["candidates"][0]
    assert best["effect"] == "leakage" and best["posterior"] > 0.8 and best["heldout_error_ratio"] < 0.5
    assert found["confidence_set"] == [["leakage"]] and found["law_left"] == best["law_left"] < 0.1
    assert best["p_value"] == found["p_value"] < 0.05
    size = best["functional"]
    assert (size["name"], size["unit"]) == ("change of pressure sum", "Pa") and 0.0 < size["ci95"][0] < size["value"] < size[
        "ci95"
    ][1]
    assert found["rests_on"]["tests"] == 24 and found["rests_on"]["conditions"] == 8 and found["rests_on"]["trajectory"] > 2
    over = [row["over_floor"] for row in found["worst"]]
    assert over == sorted(over, reverse=True) and len(over) == 8 and over[0] < 3.0
    for channel, noise_floor in found["floor"].items():
        assert noise_floor["source"] == "repetitions" and noise_floor["low"] <= noise_floor["value"] <= noise_floor["high"], (
            channel
        )
    assert found["floor"]["pressure1_mpa"]["unit"] == "MPa"
    others = [row["posterior"] for row in found["candidates"][1:]]
    # creep that is slow enough is nearly a leak, and is behind it on tests that were left out
    assert all(row["heldout_error_ratio"] > best["heldout_error_ratio"] for row in found["candidates"][1:])
    assert others and max(others) <= 0.5
    low, high = best["parameters"]["conductance"]["ci95"]
    assert low < best["parameters"]["conductance"]["value"] < high
    assert best["parameters"]["conductance"]["value"] == pytest.approx(2.2e-16, rel=0.2)
    assert found["error"]["baseline"] > 1.3 > found["error"]["augmented"] / found["error"]["floor"]
    assert found["error"]["augmented"] < 0.85 * found["error"]["baseline"]
    assert found["where"][0]["subsystem"] == "lines"
    check_rows(found["where"])
    row = found["calibration"]["coulomb_positive"]
    assert row["published"] == 5.27 and row["unit"] == "N" and row["ci95"][0] < row["value"] < row["ci95"][1]


def check_words_and_page(said: str, found: dict[str, Any], leak: Path) -> None:
    """Check what a diagnosis of tests with a leak prints, and its page."""
    assert "EFFECT   leakage" in said and "the least that 24 can show" in " ".join(said.split())
    assert "Calibrated: " in said and "nothing stands out" in said
    assert "mm3/(s MPa)" in said and "m^3" not in said
    assert f"hjcamp add leakage {leak} --as with_leakage" in said
    page = Path("diagnose/index.html").read_text(encoding="utf-8")
    assert "<svg" in page and "Effect: leakage" in page and "Water is lost from each line" in page
    assert all(name in page for name in ("published", "calibrated", "with leakage", "floor"))
    assert page.index('class="evidence"') < page.index("<math") < page.index("Effects, best first")
    assert all(said in page for said in ("missing: calibrated model", "missing: with leakage", "worst test", "these tests"))
    known = page[page.index("How well each parameter is known") :]
    assert "leakage conductance" in known and known.count("<svg") == 1 and Path("diagnose/corner.svg").is_file()
    assert "residual with itself" in page and 'href="effect_leakage.html"' in page
    assert Path("diagnose/effect_leakage.html").is_file() and read_answer(Path("diagnose/answer.json")) == found


def check_addition(added: dict[str, Any], said: str, found: dict[str, Any]) -> None:
    """Check what is said of the model with the leak, and its file."""
    error = added["error"]
    assert error["after"] < 1.3 * error["floor"] and error["after"] < 0.85 * error["before"]
    assert added["helps"] is True and "leakage helps: normalised error falls by " in said and "(8 tests, mean" in said
    # One floor for these logs, and one scale: what was held out is not all there is, but the same rig.
    assert error["before"] == pytest.approx(found["error"]["baseline"], rel=0.2)
    assert error["after"] == pytest.approx(found["error"]["augmented"], rel=0.1)
    model = yaml.safe_load(Path("conf/model/bench.yaml").read_text(encoding="utf-8"))
    assert model["name"] == "bench" and model["effects"]["leakage"]["conductance"] > 0
    origin = model["provenance"]
    assert len(origin["logs_sha256"]) == 24 and origin["tests_fitted"] == 16 and len(origin["tests_held_out"]) == 8
    assert "leakage.conductance" in origin["ci95"] and origin["command"].startswith("hjcamp add leakage")


def check_comparison(compared: dict[str, Any], said: str, added: dict[str, Any]) -> None:
    """Check the comparison of the published model with the one that has the leak."""
    assert set(compared) == {"schema", "models", "where"} and compared["schema"] == "hjcamp.comparison/1"
    before, after = compared["models"]
    assert [before["name"], after["name"]] == ["published", "bench"] and before["tests"] == after["tests"] == 24
    for channel in ("arm_deg", "pressure1_mpa", "pressure2_mpa", "pump_deg"):
        assert set(after["error"][channel]) == {"rms", "floor", "r2"}
        assert after["error"][channel]["rms"] >= 0.8 * after["error"][channel]["floor"] > 0
    assert after["error"]["pressure1_mpa"]["rms"] < 0.7 * before["error"]["pressure1_mpa"]["rms"]
    assert after["score"] < before["score"]
    for channel, error in after["error"].items():
        assert error["floor"] == before["error"][channel]["floor"] == added["channels"][channel]["floor"]
    assert after["score"] == pytest.approx(added["error"]["after"], rel=0.1)
    assert before["score"] == pytest.approx(added["error"]["start"], rel=0.1)
    assert "nothing stands out" in said and "hjcamp run campaign=controllers controller.model=bench" in said
    check_rows(compared["where"])
    for name in ("overlay.svg", "where.svg", "horizon.svg", "index.html"):
        assert (Path("out/compare") / name).is_file()


def test_a_leak_is_named_added_and_gone(call: Call, leak: Path) -> None:
    answer = call("diagnose", leak, "--effort", "quick", "--json", "d.json")
    assert answer.code == 0, answer.err
    found = read_answer(Path("d.json"))
    check_leak(found)
    check_words_and_page(answer.out, found, leak)
    answer = call("add", "leakage", leak, "--as", "bench", "--json", "a.json")
    assert answer.code == 0, answer.err
    added = read_answer(Path("a.json"))
    check_addition(added, answer.out, found)
    answer = call("add", "leakage", leak, "--as", "bench")
    assert answer.code == 2 and "exists" in answer.err
    answer = call("compare", leak, "--model", "published", "--model", "bench", "--json", "out/c.json")
    assert answer.code == 0, answer.err
    check_comparison(read_answer(Path("out/c.json")), answer.out, added)


def test_nothing_is_missing(call: Call, null: Path) -> None:
    assert call("diagnose", null, "--effort", "quick", "--json", "d.json").code == 0
    found = read_answer(Path("d.json"))
    assert found["verdict"] == "nothing_missing" and found["effects"] == [] and found["p_value"] >= 0.05
    # On the scale of `compare` whole tests are replayed: slips that come earlier or later add to what repetitions differ by.
    # another repetition in the place of the model would be sqrt(2) floors away
    assert found["error"]["augmented"] < 2**0.5 * found["error"]["floor"]
    assert found["confidence_set"] == [[]] and found["law_left"] == 0.0 and found["unknowns"] == []
    least = found["minimum_detectable"]["leakage"]
    assert set(least) == {"parameter", "value", "unit"} and 0 < least["value"] < 1e-15


@pytest.mark.study
def test_a_friction_effect_is_named(call: Call, stribeck: Path) -> None:
    assert call("diagnose", stribeck, "--effort", "quick", "--json", "d.json").code == 0
    found = read_answer(Path("d.json"))
    assert (found["verdict"], found["effects"]) == ("effect", ["stribeck_friction"])
    assert found["where"][0]["subsystem"] == "joint"


def test_one_test_cannot_tell_and_says_so_before_it_computes(call: Call, leak: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_twin(*arguments: object) -> None:
        raise AssertionError("a twin was simulated although no verdict can be given")

    monkeypatch.setattr("hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution.make_twin", no_twin)
    answer = call("diagnose", leak / "ramp_hold_r1.mcap", "--effort", "quick", "--json", "d.json")
    assert answer.code == 0, answer.err
    found = read_answer(Path("d.json"))
    assert set(found) == KEYS and found["verdict"] == "cannot_tell" and found["error"]["floor"] is None
    assert len(found["lacking"]) == 3 and found["lacking"][0].startswith("1 test(s); at least 3")
    assert "CANNOT TELL" in answer.out and "exploratory" in answer.out
    said = answer.out.index("These tests cannot tell which effect is missing")
    assert said < answer.out.index("calibrated first") and "One condition only" in answer.out
    assert "No test was repeated, so repeatability is unknown" in answer.out and "othing stands out" not in answer.out


def test_an_effect_that_gains_nothing_is_said_not_to_help(call: Call, null: Path) -> None:
    answer = call("add", "leakage", null, "--as", "idle", "--json", "a.json")
    assert answer.code == 0, answer.err
    added = read_answer(Path("a.json"))
    assert added["helps"] is False and added["fall"]["mean"] <= added["fall"]["standard_error"]
    assert "leakage DOES NOT HELP" in answer.out and "arm angle" in answer.out


@pytest.mark.parametrize(
    "spoil",
    [
        lambda c: c.update(arm_deg=np.zeros(len(c["arm_deg"]))),
        lambda c: c.update(arm_deg=-c["arm_deg"]),
        lambda c: c.update({name: values[:45] for name, values in c.items()}),
    ],
)
def test_a_comparison_ends_whatever_verify_accepts(call: Call, leak: Path, spoil: Callable[[Any], Any]) -> None:
    log = read_log(leak / "ramp_hold_r1.mcap")
    spoil(log.columns)
    write_log(Path("odd.mcap"), log)
    assert call("log", "verify", "odd.mcap").code == 0
    answer = call("compare", "odd.mcap", "--json", "c.json")
    assert answer.code == 0, answer.err
    assert "No test was repeated, so repeatability is unknown" in answer.out and "othing stands out" not in answer.out
    negative = [one for one in read_answer(Path("c.json"))["models"][0]["error"].values() if one and (one["r2"] or 0) < 0]
    assert bool(negative) == ("r2 is negative for" in answer.out)


def test_comparison_without_repetitions_is_exploratory(call: Call, leak: Path) -> None:
    answer = call("compare", *sorted(leak.glob("*_r1.mcap")), "--json", "c.json")
    assert answer.code == 0, answer.err
    assert read_answer(Path("c.json"))["models"][0]["error"]["arm_deg"]["floor"] is None
    assert "exploratory" in answer.out
    # The published model is of another specimen: where the error is without that is said too.
    assert "after calibrating its base parameters" in answer.out


@pytest.mark.study
def test_without_repetitions_the_leak_is_still_found_and_added(call: Call, leak: Path) -> None:
    once = sorted(leak.glob("*_r1.mcap"))
    answer = call("diagnose", *once, "--effort", "quick", "--json", "d.json")
    assert answer.code == 0 and "exploratory" in answer.out, answer.err
    assert read_answer(Path("d.json"))["candidates"][0]["effect"] == "leakage"
    answer = call("add", "leakage", *once, "--as", "once", "--json", "a.json")
    assert answer.code == 0 and "exploratory" in answer.out, answer.err
    error = read_answer(Path("a.json"))["error"]
    assert error["after"] < error["before"]
