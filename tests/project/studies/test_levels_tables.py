"""The tables of levels: rows of results, and that a run goes on from what is finished."""

from __future__ import annotations

import csv
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks.hidden_effects.amplitudes import true_base
from benchmarks.hidden_effects.cases import PLAN
from benchmarks.hidden_effects.ledger import Ledger
from benchmarks.levels import running as levels
from benchmarks.levels.tables import COLUMNS, effect_row, interval_rows, row_of, write_tables

CHANNELS = ("arm", "difference", "line_sum", "line_difference", "sliding")


def line(effect: str = "encoder_lag", named: tuple[str, ...] = ("encoder_lag",), seed: int = 7) -> dict[str, Any]:
    """A finished rig with a late encoder, as a diagnosis tells of it."""
    base = {f"{kind}_{way}": 4.0 for kind in ("static", "coulomb", "viscous") for way in ("positive", "negative")}
    base |= {"stiffness1": 2.0e13, "stiffness2": 2.2e13, "slider_mass": 0.01, "arm_mass": 0.01}
    rows = {"lag": {"value": 0.0033, "unit": "s", "ci95": [0.003, 0.0036]}, "dead_share": {"value": 0.5, "unit": "1"}}
    one = {"effect": effect, "before": [1.5] * 7, "after": [0.9] * 7, "second": "leakage", "gain": 4.8, "against": {}}
    deviations = [["", "coulomb_positive", 4.4, 0.02, 7], ["", "moving_mass", 0.02, 0.1, 7], [effect, "lag", 0.0033, 0.01, 7]]
    return {
        "plan": PLAN, "tag": "code", "effort": "standard", "visibility": {},
        "seed": seed, "name": f"{effect}-{seed}", "effects": [effect], "laws": {}, "strength": "medium", "contact": "sharp",
        "truth": {"base": base, "changes": {effect: {"encoder_delay": 0.003}}},
        "answer": {"verdict": "effect", "effects": list(named), "candidates": [{"effect": effect, "parameters": rows}]},
        "behind": {"one_effect": one, "deviations": deviations, "over": [0.8] * 7, "tests": 24, "steps": []},
        "processor_seconds": 12.0,
    }  # fmt: skip


def test_a_row_tells_what_the_first_effect_leaves_and_the_second_gains() -> None:
    row = effect_row(line())
    assert (row["known"], row["found"], row["exact"], row["second_gain"]) == (1, "encoder_lag", 0, "4.8")
    assert {row[f"before_{name}"] for name in CHANNELS} == {"1.5"} and row["after_arm"] == "0.9"
    against = line("gravity_load", ("gravity_load",))
    against["behind"]["one_effect"]["against"] = {"left": -0.0123, "straight": 0.25, "bent": 1.5}
    exact = effect_row(against)
    assert (row["left"], exact["exact"], exact["left"], exact["bent"]) == ("", 1, "-0.0123", "1.5")
    nothing = line()
    nothing["behind"]["one_effect"] = {}
    bare = effect_row(nothing)
    assert (bare["found"], bare["second_gain"]) == ("", "0") and bare["before_arm"] == bare["after_arm"] == "0.8"
    assert effect_row(line("stray_spring", ("gravity_load",)))["known"] == 0


def test_intervals_are_of_parameters_whose_truth_is_known_where_the_effect_alone_was_named() -> None:
    rows = {row["parameter"]: row for row in interval_rows(line())}
    assert set(rows) == {"coulomb_positive", "moving_mass", "lag"}
    assert float(rows["lag"]["error"]) == pytest.approx(0.0953, abs=1e-4)  # ln(3.3 / 3.0)
    assert float(rows["coulomb_positive"]["error"]) == pytest.approx(0.0953, abs=1e-4)
    assert true_base(line())["moving_mass"] == pytest.approx(0.02) and float(rows["moving_mass"]["error"]) == 0.0
    assert interval_rows(line(named=("encoder_lag", "leakage"))) == interval_rows(line(named=())) == []


def test_rigs_that_failed_are_in_no_table(tmp_path: Path) -> None:
    write_tables(tmp_path / "effects.csv", [line(seed=8), line(seed=7), {"seed": 9, "failure": "UsageError"}], True)
    with (tmp_path / "effects.csv").open(encoding="utf-8") as file:
        assert [row["seed"] for row in csv.DictReader(file)] == ["7", "8"]
    assert len((tmp_path / "intervals.csv").read_text(encoding="utf-8").splitlines()) == 1 + 2 * 3


def test_every_effect_comes_in_both_strengths_and_those_outside_the_library_from_other_seeds() -> None:
    cases = levels.with_effects(930_000, 132)
    known = [case for case in cases if case.kind == "single"]
    assert len(known) == 132 and len({(case.effects, case.strength) for case in known}) == 44
    others = [case for case in cases if case.kind == "outside"]
    assert len(others) == 42 and min(case.seed for case in others) == 940_000
    # both kinds in turn, so that a run that is stopped has of each
    assert [case.kind for case in cases[:4]] == ["single", "outside"] * 2
    assert len({case.seed for case in cases}) == len(cases)


def test_a_run_goes_on_from_what_is_finished(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    part, asked = Ledger(tmp_path / "effects.jsonl"), list[int]()
    given: Any = SimpleNamespace(tag="code", effort="standard")
    cases = levels.with_effects(930_000, 3)
    part.add(line(seed=930_000) | {"name": cases[0].name})
    with part.path.open("a", encoding="utf-8") as file:
        file.write('{"seed": 930001, "na')

    def results(left: Any, given: Any, seen: Any) -> Any:
        asked.extend(case.seed for case in left)
        yield line(seed=930_001)
        raise KeyboardInterrupt

    monkeypatch.setattr(levels, "results", results)
    assert not levels.finished(part, cases, given)
    assert 930_000 not in asked and 930_001 in asked
    assert [one["seed"] for one in part.lines("code")] == [930_000, 930_001]
    # what other code has finished is none of these
    assert part.lines("other") == []


def test_an_amplitude_that_is_fitted_as_none_has_no_error() -> None:
    one = line()
    one["answer"]["candidates"][0]["parameters"]["lag"]["value"] = 0.0
    assert {row["parameter"] for row in interval_rows(one)} == {"coulomb_positive", "moving_mass"}


def null(seed: int, **gains: float) -> dict[str, Any]:
    """A finished rig with nothing missing, of which a screening promises these gains."""
    step = {"weights": dict.fromkeys(gains, 0.1) | {max(gains, key=lambda one: gains[one]): 0.9}, "screened": gains}
    behind = {"tests": 24, "over": [0.9] * 7, "steps": [step | {"counted": max(gains.values()) + 1.0, "p_value": 0.2}]}
    answer = {"verdict": "nothing_missing", "effects": []}
    return line(seed=seed) | {"name": f"null-{seed}", "effects": [], "behind": behind, "answer": answer}


def test_a_row_of_a_rig_with_nothing_missing_tells_what_each_effect_promises() -> None:
    row = row_of(null(8, leakage=0.2, dither_relief=3.25))
    assert set(row) == set(COLUMNS) and (row["best"], row["gain"]) == ("dither_relief", "4.25")
    assert (row["gain_leakage"], row["gain_dither_relief"], row["gain_presliding"]) == ("0.2", "3.25", "0")
    empty = null(8, leakage=0.2)
    empty["behind"]["steps"] = []
    assert (row_of(empty)["best"], row_of(empty)["gain"], row_of(empty)["twins_p"]) == ("", "0", "1")


def test_a_run_leaves_its_table_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(levels, "code_version", lambda: "code")
    monkeypatch.setattr(
        levels, "results", lambda left, *given: (null(case.seed, leakage=0.2, dither_relief=3.25) for case in left)
    )
    assert levels.main(["--seeds", "910000", "3", "--into", str(tmp_path / "nulls.csv")]) == 0
    with (tmp_path / "nulls.csv").open(encoding="utf-8") as file:
        assert [row["seed"] for row in csv.DictReader(file)] == ["910000", "910001", "910002"]
    assert [path.name for path in tmp_path.iterdir()] == ["nulls.csv"]
