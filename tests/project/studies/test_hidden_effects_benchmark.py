"""The hidden-effect benchmark: its scoring on made-up answers."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from truth.pump_joint.case import build_case, sealed_answer
from truth.pump_joint.hidden import LIBRARY_NAMES

from benchmarks.hidden_effects.amplitudes import AMPLITUDES, LEFT_OUT, amplitude_of, true_base
from benchmarks.hidden_effects.cases import PLAN, plan
from benchmarks.hidden_effects.judging import detectable, matched, outcome, right, said
from benchmarks.hidden_effects.measure import Measure, at_least, at_most, share, wilson
from benchmarks.hidden_effects.measures import all_measures
from benchmarks.hidden_effects.page import page
from benchmarks.hidden_effects.tables import distance_text, failures_table, forms_table, value_text
from hjcamp.effects import load_effects

LIBRARY = load_effects([])


def made_up(
    verdict: str,
    names: tuple[str, ...] = (),
    hidden: tuple[str, ...] = ("leakage",),
    kind: str = "single",
    seen: float = 3.0,
    **more: Any,
) -> dict[str, Any]:
    """A result with an answer of our choosing and the sealed answer of a real case."""
    strength = more.pop("strength", "medium")
    seed = more.pop("seed", 7)
    truth = json.loads(json.dumps(sealed_answer(build_case(hidden, strength, seed), strength, "standard")))
    rows = more.pop("parameters", None)
    candidates = [
        {"effect": name, "posterior": 0.9, "heldout_error_ratio": 0.5, "parameters": parameter_rows(name, rows)}
        for name in more.pop("candidates", names)
    ]
    answer = {
        "verdict": verdict,
        "effects": list(names),
        "drivers": more.pop("drivers", []),
        "p_value": 0.02,
        "candidates": candidates,
        "error": more.pop("error", {"baseline": 2.0, "augmented": 1.1, "floor": 1.0}),
        "calibration": more.pop("calibration", {}),
    }
    return {
        "plan": PLAN,
        "tag": "made-up",
        "effort": "standard",
        "name": more.pop("name", f"{kind}-{'+'.join(hidden)}-{seed}"),
        "kind": kind,
        "effects": list(hidden),
        "strength": strength,
        "seed": seed,
        "contact": more.pop("contact", "asperities"),
        "laws": more.pop("laws", {}),
        "truth": truth,
        "visibility": {effect: [seen, "sine/arm_deg"] for effect in hidden},
        "answer": answer,
        "seconds": 20.0,
        "processor_seconds": 18.0,
        "behind": {"reason": "made up"},
    } | more


def parameter_rows(name: str, rows: dict[str, tuple[float, float, float]] | None) -> dict[str, Any]:
    """Fitted parameters of a candidate: those given, else the library's own values."""
    given = rows or {one: (value, 0.5 * value, 1.5 * value) for one, value in LIBRARY[name].defaults().items()}
    return {one: {"value": value, "unit": "", "ci95": [low, high]} for one, (value, low, high) in given.items()}


def broken(**more: Any) -> dict[str, Any]:
    """A result whose diagnosis raised."""
    line = made_up("effect", ("leakage",), **more)
    del line["answer"]
    return line | {"failure": "ValueError: no luck"}


def measure(lines: list[dict[str, Any]], title: str) -> Measure:
    (found,) = [one for one in all_measures(lines) if one.title == title]
    return found


@pytest.mark.parametrize(
    ("verdict", "names", "hidden", "kind", "seen", "strict", "groups"),
    [
        ("effect", ("leakage",), ("leakage",), "single", 3.0, True, True),
        ("effect", ("leakage", "tubing_creep"), ("leakage",), "single", 3.0, False, False),
        ("effect", ("tubing_creep",), ("leakage",), "single", 0.5, False, False),
        ("effect", ("line_inertance",), ("payload_inertia",), "single", 3.0, False, True),
        ("one_of", ("payload_inertia", "line_inertance"), ("payload_inertia",), "single", 3.0, False, True),
        ("one_of", ("leakage", "tubing_creep"), ("leakage",), "single", 3.0, False, False),
        ("nothing_missing", (), ("leakage",), "single", 0.5, False, True),
        ("nothing_missing", (), ("leakage",), "single", 3.0, False, False),
        ("nothing_missing", (), (), "null", 0.0, True, True),
        ("outside_library", (), (), "null", 0.0, False, False),
        ("effect", ("gravity_load", "leakage"), ("leakage", "gravity_load"), "pair", 3.0, True, True),
        ("effect", ("leakage",), ("leakage", "gravity_load"), "pair", 3.0, False, False),
        ("effect", ("line_inertance", "payload_inertia"), ("leakage", "payload_inertia"), "pair", 3.0, False, False),
        ("outside_library", (), ("stray_spring",), "outside", 3.0, True, True),
        ("nothing_missing", (), ("stray_spring",), "outside", 0.5, False, True),
        ("effect", ("leakage",), ("leakage",), "taken_out", 3.0, False, False),
    ],
)
def test_a_verdict_is_right_or_not(
    verdict: str, names: tuple[str, ...], hidden: tuple[str, ...], kind: str, seen: float, strict: bool, groups: bool
) -> None:
    line = made_up(verdict, names, hidden, kind, seen)
    assert (right(line, False), right(line, True)) == (strict, groups)


def test_a_diagnosis_that_breaks_off_is_wrong_and_listed() -> None:
    line = broken()
    assert not right(line) and outcome(line) == "failed"
    assert measure([line], "right effect first, where detectable").value == 0.0
    assert "ValueError: no luck" in failures_table([line])


def test_of_a_pair_one_name_is_half_and_a_wrong_one_is_wrong() -> None:
    pair = ("leakage", "gravity_load")
    assert outcome(made_up("effect", ("leakage",), pair, "pair")) == "half"
    assert outcome(made_up("effect", ("leakage", "encoder_lag"), pair, "pair")) == "wrong"
    assert not matched(made_up("effect", ("leakage", "leakage"), pair, "pair"), True)
    lines = [made_up("effect", names, pair, "pair") for names in (pair, pair[:1], ("encoder_lag",))]
    assert measure(lines, "two effects, exactly both").value == pytest.approx(100 / 3)
    assert measure(lines, "... at least one right, none wrong").value == pytest.approx(200 / 3)


def test_names_given_are_counted_one_by_one() -> None:
    lines = [
        made_up("effect", ("leakage",)),
        made_up("effect", ("leakage", "encoder_lag")),
        made_up("effect", ("encoder_bias",), (), "null"),
        made_up("one_of", ("encoder_bias", "encoder_lag"), (), "null"),
        made_up("effect", ("line_inertance",), ("payload_inertia",)),
    ]
    groups = measure(lines, "wrong name among all names given with certainty; library and nulls")
    assert (groups.value, groups.count) == (pytest.approx(40.0), 5)
    assert measure(lines, "... the other name of the same thing counted as wrong").value == pytest.approx(60.0)
    assert measure(lines, "nulls in which something is named").value == 100.0
    assert measure(lines, "one of several without the true one").value == 100.0


def test_outside_the_library_counts_what_was_said_and_its_driver() -> None:
    lines = [
        made_up("outside_library", (), ("stray_spring",), "outside", drivers=["arm_angle", "time"]),
        made_up("outside_library", (), ("stray_spring",), "outside", drivers=["time", "arm_angle"]),
        made_up("effect", ("gravity_load",), ("stray_spring",), "outside"),
        made_up("outside_library", (), ("leakage",), "taken_out"),
        made_up("nothing_missing", (), ("stray_spring",), "outside", 0.3),
    ]
    assert measure(lines, "outside the library: said so, where detectable").value == pytest.approx(75.0)
    assert measure(lines, "... right driver first (never in it, detectable)").value == pytest.approx(100 / 3)
    assert measure(lines, "... right driver first, where it was said").value == pytest.approx(50.0)
    assert measure(lines, "... a name with certainty, all strengths").value == pytest.approx(20.0)


def test_the_error_removed_is_held_against_what_nulls_leave_and_the_floor() -> None:
    null = made_up("nothing_missing", (), (), "null", error={"baseline": 1.2, "augmented": 1.2, "floor": 1.0})
    none_left = made_up("nothing_missing", (), error={"baseline": 1.25, "augmented": 1.25, "floor": 1.0})
    found = [one for one in all_measures([made_up("effect", ("leakage",)), null, none_left]) if "median (best" in one.title]
    assert [one.value for one in found] == pytest.approx([0.9 / 0.8, 0.9 / 0.8, 0.45])
    assert [one.count for one in found] == [1, 1, 2]


def test_what_a_contact_leaves_by_itself_is_no_part_of_what_can_be_removed() -> None:
    nulls = [
        made_up("nothing_missing", (), (), "null", contact=contact, error={"baseline": left, "augmented": left})
        for contact, left in (("asperities", 1.1), ("smooth", 1.6))
    ]
    hidden = made_up("effect", ("leakage",), contact="smooth", error={"baseline": 2.0, "augmented": 1.7})
    found = [one for one in all_measures([hidden, *nulls]) if "median (best" in one.title]
    assert [one.value for one in found] == pytest.approx([0.3 / 0.4, 0.3 / 0.65, 0.3])


def test_amplitudes_are_those_of_the_sealed_answer() -> None:
    leak = {"conductance": (2.0e-16, 1.9e-16, 2.1e-16), "threshold": (0.4e6, 0.0, 1e6), "conductance_above": (5e-16, 0, 1)}
    line = made_up("effect", ("leakage",), parameters=leak)
    hidden = line["truth"]["changes"]["leakage"]
    gap = 1 + hidden["leak_gap_growth"] * max(0.5e6 - hidden["leak_opening_pressure"], 0.0)
    # a fifth of what runs out at 0.5 MPa does so above the threshold, by the other slope
    assert amplitude_of(line, "leakage") == (pytest.approx(2.2e-16 * gap**3), pytest.approx(3.0e-16), False)
    weight = {"load_mass": (0.01, 0.0, 1.0), "radius": (0.02, 0.0, 1.0), "rest_angle": (0.0, 0.0, 0.0)}
    true, ours, covered = amplitude_of(
        made_up("effect", ("gravity_load",), ("gravity_load",), parameters=weight), "gravity_load"
    )  # type: ignore[misc]
    assert (true, covered) == (0.55, None)
    assert ours == pytest.approx(0.01 * 9.81 * 0.02 / 0.00341)
    stiff = {"compliance": (1 / 1.8e4, 0.9 / 1.8e4, 1.1 / 1.8e4), "friction_share": (0.3, 0.2, 0.4)}
    known = amplitude_of(
        made_up("effect", ("string_elasticity",), ("string_elasticity",), parameters=stiff), "string_elasticity"
    )
    assert known == (pytest.approx(0.3 * 4.12 / 1.8e4), pytest.approx(0.3 * 4.12 / 1.8e4), True)
    # twice as soft where it is loaded little, as stiff as the linear one under 6 N
    soft = AMPLITUDES["string_elasticity"].truth({"string_stiffness": 1.8e4, "string_hardening": 4.714e-4}, {})
    assert 1.4 < soft / (0.3 * 4.12 / 1.8e4) < 2.0


def test_amplitudes_of_other_laws_are_what_both_change_where_the_arm_goes() -> None:
    # friction from 1 to 1.5: as a bump, and as the curve of von Mises that is as wide
    truth = {"angle_amplitude": 0.25, "angle_phase": 0.0, "angle_form": 1.0}
    bump = {"amplitude": 0.5, "period": 2 * math.pi, "phase": math.pi / 2, "concentration": 6.0}
    entry = AMPLITUDES["position_friction"]
    assert entry.truth(truth, {}) == pytest.approx(0.2, rel=1e-3) == pytest.approx(entry.ours(bump), rel=0.02)
    sine = {**bump, "amplitude": 0.1, "concentration": 0.0}
    assert entry.ours({**sine, "phase": 0.0}) == pytest.approx(0.1 * math.sin(math.radians(80)), rel=1e-3)
    disc = {"disc_eccentricity": 0.03, "disc_phase": 0.0}
    once, oval = (AMPLITUDES["encoder_eccentricity"].truth({**disc, "disc_form": form}, {}) for form in (0.0, 1.0))
    assert once == pytest.approx(0.03, rel=0.05) and 1.1 < oval / once < 1.4
    crossing = {"cross_conductance": 1e-15, "cross_turbulent_pressure": 1e12}
    base = {"coulomb_positive": 5.0, "coulomb_negative": 4.0}
    assert AMPLITUDES["cross_leakage"].truth(crossing, base) == pytest.approx(1e-15)


def test_every_effect_of_the_truth_plant_has_an_amplitude_or_a_reason() -> None:
    assert set(AMPLITUDES) | set(LEFT_OUT) == set(LIBRARY_NAMES)
    for name, entry in AMPLITUDES.items():
        case = build_case((name,), "medium", 3)
        fitted = LIBRARY[name].defaults()
        assert math.isfinite(entry.truth(case.changes[name], sealed_answer(case, "medium", "standard")["base"]))  # type: ignore[arg-type]
        assert math.isfinite(entry.ours(fitted))
        assert not entry.single or entry.single in fitted


def test_the_base_of_a_rig_with_pressure_friction_is_that_at_no_pressure() -> None:
    plain, pressed = made_up("effect", ("leakage",)), made_up("effect", ("leakage",), ("pressure_friction",))
    fall = true_base(plain)["coulomb_positive"] - true_base(pressed)["coulomb_positive"]
    assert fall == pytest.approx(2e-6 * 0.8e6)
    assert "static_positive" not in true_base(made_up("effect", (), ("static_friction_ageing",)))


def test_coverage_is_judged_where_the_verdict_is_right() -> None:
    base = true_base(made_up("nothing_missing", (), (), "null"))
    held = {name: {"value": value, "ci95": [value - 1e-9, value + 1e-9]} for name, value in base.items()}
    held["moving_mass"] = {"value": 1.0, "ci95": [0.9, 1.1]}
    lines = [
        made_up("nothing_missing", (), (), "null", calibration=held),
        made_up("effect", ("encoder_lag",), (), "null", calibration=held),
    ]
    found = measure(lines, "coverage of 95 % intervals, base parameters and amplitudes")
    assert (found.count, found.spoiled) == (9, (("moving_mass", 1),))


def test_the_width_of_intervals_is_that_of_amplitudes_that_can_be_compared() -> None:
    # of presliding no number means the same in the truth plant
    rows = {"encoder_bias": {"bias": (0.05, 0.04, 0.06)}, "encoder_lag": {"lag": (0.02, 0.012, 0.028)}, "presliding": None}
    lines = [made_up("effect", (name,), (name,), parameters=given) for name, given in rows.items()]
    found = measure(lines, "half width of these intervals of amplitudes, median")
    assert (found.value, found.count) == (pytest.approx(30.0), 2)


def test_shares_have_wilson_intervals_and_say_who_spoils_them() -> None:
    assert wilson(48, 50) == pytest.approx((86.5, 98.9), abs=0.1)
    lines = [made_up("effect", ("leakage",)), made_up("effect", ("leakage",), ("gravity_load",))]
    found = share("x", lines, lambda line: right(line), at_least("", 85, 93))
    assert found.spoiled == (("gravity_load", 1),)
    assert distance_text(found) == "good missed by 35 %: gravity_load 1"
    assert distance_text(Measure("x", 4.0, 30, at_most("", 8, 3))) == "good; goal missed by 1 %"
    assert distance_text(Measure("x", 2.0, 30, at_most("", 8, 3))) == "goal met"
    assert value_text(share("x", [], lambda line: True)) == "no case"


def test_detectable_needs_every_hidden_effect() -> None:
    line = made_up("effect", ("leakage",), ("leakage", "gravity_load"), "pair")
    assert detectable(line)
    line["visibility"]["gravity_load"][0] = 0.9
    assert not detectable(line)
    assert said(made_up("outside_library", drivers=["time"])) == "outside: time"


def test_cases_are_counted_by_contact_and_by_law() -> None:
    lines = [
        made_up("effect", ("leakage",), contact="sharp", laws={"leakage": "laminar"}),
        made_up("outside_library", contact="sharp", laws={"leakage": "gap"}),
        made_up("nothing_missing", contact="sharp", laws={"leakage": "gap"}, seen=0.4),
        made_up("effect", ("presliding",), ("gravity_load",), contact="smooth"),
        made_up("nothing_missing", (), (), "null", contact="smooth"),
        made_up("effect", ("leakage",), (), "null", contact="smooth"),
        made_up("outside_library", (), ("stray_spring",), "outside", contact="smooth", laws={"stray_spring": "cubic"}),
    ]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in forms_table(lines).splitlines()[2:]]
    assert rows == [
        # title, nulls, library, right, one of, outside, nothing, wrong, outside said
        ["contact: smooth", "1 of 2", "1", "", "", "", "", "1", "1 of 1"],
        ["contact: sharp", "", "2", "1", "", "1", "", "", ""],
        ["law of the effect: its only one", "", "1", "", "", "", "", "1", ""],
        ["law of the effect: the first", "", "1", "", "", "1", "", "", ""],
        ["law of the effect: another", "", "1", "1", "", "", "", "", ""],
        ["leakage: gap", "", "1", "", "", "1", "", "", ""],
        ["leakage: laminar", "", "1", "1", "", "", "", "", ""],
    ]


def test_the_page_has_every_part_also_of_a_few_results() -> None:
    cases = plan("full")
    lines = []
    for case in cases[::9]:
        names = case.effects if case.kind in ("single", "pair") else ()
        verdict = {"single": "effect", "pair": "effect", "null": "nothing_missing"}.get(case.kind, "outside_library")
        line = made_up(verdict, names, case.effects, case.kind, name=case.name)
        lines.append(line | {"strength": case.strength, "seed": case.seed})
    lines.append(dict(lines[0]) | {"effort": "quick", "seconds": 9.0})
    text = page(lines, cases, "standard", "made-up", "python -m benchmarks.hidden_effects", 2)
    for part in (
        "## Measures",
        "## By contact and by law",
        "## Hidden and said",
        "## Other efforts",
        "| nothing hidden |",
        "quick, one thread",
        "**Only",
    ):
        assert part in text
    assert "nan" not in text
