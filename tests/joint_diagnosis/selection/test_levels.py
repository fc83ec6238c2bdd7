"""The numbers that decide a verdict are read from tables of rigs with nothing or one effect missing, and from nothing else."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.plants.pump_joint.diagnosis import levels
from hjcamp.plants.pump_joint.diagnosis.levels import (
    CERTAIN,
    CHANNELS,
    LEVEL,
    best_gains,
    chance,
    forms,
    law,
    laws_off,
    least_gain,
    margin,
    parted,
    promises_a_test,
    second_gain,
    second_gains,
    usual_gain,
)
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS as SEEN
from hjcamp.plants.pump_joint.diagnosis.selection.verdict import AGAINST

ROWS = levels.rows_of(levels.TABLE)


def test_the_channels_are_those_that_a_verdict_judges() -> None:
    assert SEEN[: len(CHANNELS)] == CHANNELS


def test_all_that_speaks_against_a_law_has_its_words() -> None:
    assert set(AGAINST) <= set(levels.rows_of(levels.EFFECTS)[0])


def test_the_table_has_two_hundred_rigs_and_four_contacts() -> None:
    assert len(ROWS) >= 200 and len({row["seed"] for row in ROWS}) == len(ROWS)
    contacts = Counter(row["contact"] for row in ROWS)
    assert set(contacts) == {"asperities", "bristles", "smooth", "sharp"} and min(contacts.values()) >= 30


def test_one_rig_in_forty_gains_more_than_is_asked_and_one_in_forty_leaves_more_than_is_allowed() -> None:
    tests = np.array([int(row["tests"]) for row in ROWS])
    gains = np.array([float(row["gain"]) for row in ROWS])
    asked = [least_gain(row["best"], count) for row, count in zip(ROWS, tests, strict=True)]
    replicates = np.array([float(row["twins_p"]) for row in ROWS])
    assert np.mean((gains >= asked) & (replicates < CERTAIN)) == pytest.approx(LEVEL, abs=0.005)
    over = np.array([max(float(row[name]) for name in CHANNELS) for row in ROWS])
    assert np.mean(over > margin()) == pytest.approx(LEVEL, abs=0.005)


def test_chance_falls_with_the_gain_a_test_and_is_never_nought() -> None:
    rigs = len(best_gains())
    for name in ("leakage", "dither_relief"):
        least = least_gain(name, 24)
        asked = [chance(name, share * least, 24) for share in (0.0, 0.2, 0.5, 1.0, 1e9)]
        assert asked == sorted(asked, reverse=True) and asked[0] == 1.0 and asked[-1] == 1.0 / (rigs + 1)
        assert chance(name, least, 24) == pytest.approx(LEVEL, abs=0.01)
    assert chance("dither_relief", 10.0, 48) == chance("dither_relief", 5.0, 24)
    assert least_gain("dither_relief", 48) == 2.0 * least_gain("dither_relief", 24)


def test_an_effect_that_often_gains_by_chance_is_asked_more() -> None:
    assert set(promises_a_test()) == set(load_effects([], plant="pump_joint"))
    assert least_gain("dither_relief", 24) > least_gain("leakage", 24)
    # noise gives one free amplitude half a nat; nothing is known of an effect of one's own
    assert usual_gain("leakage", 24) == usual_gain("leakage", 6) == 0.5
    assert usual_gain("an_effect_of_a_student", 24) == 24 * max(promises_a_test().values()) > 1.0


def test_the_numbers_are_read_from_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    head = ",".join(["tests", "twins_p", "best", "gain", "gain_leakage", "gain_encoder_lag", *CHANNELS])
    lines = [
        ",".join(["10", "0.02", "leakage", str(place), str(place), "0.1", *["1.0"] * 4, str(1.0 + 0.01 * place)])
        for place in range(41)
    ]
    path = tmp_path / "nulls.csv"
    path.write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")
    caches = levels.best_gains, levels.times_asked, levels.promises_a_test, levels.margin
    monkeypatch.setattr(levels, "TABLE", path)
    try:
        for cache in caches:
            cache.cache_clear()
        usual = sum(range(41)) / 41
        assert least_gain("leakage", 10) == pytest.approx(39.0) and margin() == pytest.approx(1.39)
        assert least_gain("encoder_lag", 10) == pytest.approx(39.0 * 0.5 / usual)
        assert chance("leakage", 39.0, 10) == chance("encoder_lag", 19.5 / usual, 10) == pytest.approx(3 / 42)
    finally:
        for cache in caches:
            cache.cache_clear()


def test_a_law_may_be_off_so_far_that_both_errors_together_are_least() -> None:
    known, outside = laws_off()
    assert len(known) >= 80 and len(outside) >= 10
    both = [np.mean(known > one) + np.mean(outside <= one) for one in np.linspace(0.0, 2.0, 401)]
    assert np.mean(known > law()) + np.mean(outside <= law()) <= min(both)


@pytest.mark.parametrize("kind", AGAINST)
def test_what_speaks_against_an_exact_law_parts_its_effect_from_others(kind: str) -> None:
    known, others = levels.spoken_against(kind)
    assert len(known) >= 6 and len(others) >= 6
    asked = levels.exact(kind)
    both = [np.mean(known > one) + np.mean(others <= one) for one in np.linspace(0.0, 20.0, 2001)]
    assert 0.0 <= asked < math.inf and np.mean(known > asked) + np.mean(others <= asked) <= min(both)


def test_two_kinds_of_rigs_are_parted_in_the_middle_between_them() -> None:
    assert parted(np.array([-1.0, 0.2]), np.array([0.6, np.inf])) == pytest.approx(0.4)
    # one of the known lies among the others: it is given up
    assert parted(np.array([0.1, 0.2, 0.3, 5.0]), np.array([0.5, 1.0, 7.0])) == pytest.approx(0.4)
    assert parted(np.array([]), np.array([1.0])) == parted(np.array([1.0]), np.array([])) == math.inf


def test_a_second_effect_is_asked_what_one_rig_in_forty_with_one_effect_gains() -> None:
    gains = second_gains()
    assert np.mean(gains > second_gain(1)) == pytest.approx(LEVEL, abs=1.0 / len(gains))


@pytest.fixture
def few(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Ten rigs whose law is off by 1 to 10 % of what it explains, ten of another effect with 6 to 15 %, and one that counts nowhere."""
    head = ["known", "effect", "found", "exact", "tests", "second", "second_gain", "seed"]
    head += [f"{when}_{name}" for when in ("before", "after") for name in CHANNELS]
    lines = []
    for place in range(10):
        for known, effect, off in ((1, "leakage", 0.01 * (place + 1)), (0, "spring", 0.01 * (place + 6))):
            after = (margin() ** 2 + 100.0 * off**2) ** 0.5
            before = (100.0 + after**2) ** 0.5
            row = [known, effect, "leakage", 0, 10, "leakage", place, place, *[repr(before)] * 5, *[repr(after)] * 5]
            lines.append(",".join(map(str, row)))
    lines.append(",".join(map(str, [1, "leakage", "spring", 0, 10, "leakage", 1e6, 99, *["9.0"] * 5, *["8.0"] * 5])))
    path = tmp_path / "effects.csv"
    path.write_text("\n".join([",".join(head), *lines]) + "\n", encoding="utf-8")
    caches = levels.law, levels.laws_off, levels.second_gains
    monkeypatch.setattr(levels, "EFFECTS", path)
    for cache in caches:
        cache.cache_clear()
    yield
    for cache in caches:
        cache.cache_clear()


@pytest.mark.usefixtures("few")
def test_both_numbers_are_read_from_the_table_of_effects() -> None:
    known, outside = laws_off()
    assert known == pytest.approx(0.01 * np.arange(1, 11)) and outside == pytest.approx(0.01 * np.arange(6, 16))
    # from 5 % to 6 % five of ten rigs are refused and none accepted, then four and one, and so on up to 10 %
    assert law() == pytest.approx(0.08)
    assert second_gain(10) == pytest.approx(9 - 0.025 * 9)


def test_the_form_of_laws_makes_nineteen_of_twenty_intervals_hold_the_truth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, caches = tmp_path / "intervals.csv", (forms.form_of, forms._needed)
    errors = np.linspace(0.0, 0.2, 99)
    rows = [f"{k},leakage,conductance,{error:.6f},0.01,7" for k, error in enumerate(errors)]
    rows += [f"{k},,coulomb_positive,{0.01 * (-1) ** k},0.02,7" for k in range(6)]
    rows += ["90,tubing_creep,share,0.9,0.01,7", *[f"{k},entrained_air,air_volume,0.1,0.0,7" for k in range(3)]]
    path.write_text("seed,effect,parameter,error,deviation,freedom\n" + "\n".join(rows) + "\n", encoding="utf-8")
    monkeypatch.setattr(forms, "TABLE", path)
    for cache in caches:
        cache.cache_clear()
    try:
        form, t = forms.form_of("leakage", "conductance"), 2.364624
        # the 95th smallest of 99
        assert t * np.hypot(0.01, form) == pytest.approx(errors[94], rel=1e-4)
        # the largest of three rigs; of one rig nothing is told: as of all effects together
        assert forms.form_of("entrained_air", "air_volume") == pytest.approx(0.1 / t)
        assert forms.form_of("tubing_creep", "share") == forms.form_of("a_law_of_a_student", "strength") > form
        assert forms.form_of("", "coulomb_positive") == forms.form_of("", "viscous_positive") == 0.0
    finally:
        for cache in caches:
            cache.cache_clear()


def test_a_table_of_intervals_stands_beside_that_of_effects() -> None:
    assert all(0.0 < forms.form_of("", f"{kind}_positive") < 0.3 for kind in ("static", "coulomb", "viscous"))
    assert 0.0 < forms.form_of("a_law_of_a_student", "strength") < 0.5
