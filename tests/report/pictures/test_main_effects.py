"""The effect of what a campaign varies: the contrast by hand and against SciPy's, which axes count, the sheet, the picture."""

from __future__ import annotations

from itertools import product

import numpy as np
import polars as pl
import pytest
from scipy.stats import t as student
from scipy.stats import ttest_ind

from hjcamp.report.pictures.main_effects import draw_main_effects
from hjcamp.report.runs.indicators import INDICATORS
from hjcamp.report.runs.origin import RunOrigin
from hjcamp.report.tables.factors import ALL, Factor, effects_of, effects_sheet, factors_of, samples_of
from hjcamp.report.tables.welch import Sample, contrast

GAINS = ("kp=1.05", "kp=0.7")
MOTIONS = ("ramp", "sine")
AXES = {"trajectory": list(MOTIONS), "controller.positive.kp": list(GAINS)}


def origin(axes: dict[str, list[str]] = AXES) -> RunOrigin:
    """Return a run over the axes; the first label of a condition is what is asked where the axis is the trajectory."""
    names = list(product(*axes.values()))
    asked = list(axes).index("trajectory") if "trajectory" in axes else None
    conditions = [
        {"name": "__".join(one), "config": {"trajectory": {"name": "ramp" if asked is None else one[asked]}}} for one in names
    ]
    return RunOrigin(plan={"axes": axes, "conditions": conditions})


def frame(values: dict[str, list[float]], indicator: str = "rmse1_deg") -> pl.DataFrame:
    rows = [{"condition": name, indicator: value} for name, given in values.items() for value in given]
    empty = dict.fromkeys((name for name in INDICATORS if name != indicator), None)
    return pl.DataFrame(
        [{**empty, **row} for row in rows], schema={"condition": pl.String} | dict.fromkeys(INDICATORS, pl.Float64)
    )


@pytest.mark.parametrize(("n", "m", "scale"), [(7, 7, 1.0), (3, 12, 5.0), (2, 2, 0.1), (40, 5, 2.0)])
def test_one_pair_is_welchs_test_with_its_interval(n: int, m: int, scale: float) -> None:
    random = np.random.default_rng(n)
    one, other = random.normal(1.0, 1.0, n), random.normal(1.5, scale, m)
    known = ttest_ind(one, other, equal_var=False)
    samples = [Sample(float(x.mean()), float(x.std(ddof=1)), len(x)) for x in (one, other)]
    difference, half, p = contrast(samples[:1], samples[1:])
    assert difference == pytest.approx(one.mean() - other.mean()) and p == pytest.approx(known.pvalue, rel=1e-9)
    interval = known.confidence_interval()
    assert half == pytest.approx((interval.high - interval.low) / 2, rel=1e-9)


def test_the_mean_of_two_pairs_by_hand() -> None:
    # four samples of v = 0.04 / (4 * 5) = 0.002; nu = 0.008^2 / (4 * 0.002^2 / 4) = 16
    ours, theirs = [Sample(2.0, 0.2, 5), Sample(4.0, 0.2, 5)], [Sample(1.0, 0.2, 5), Sample(3.4, 0.2, 5)]
    difference, half, p = contrast(ours, theirs)
    assert difference == pytest.approx(0.8) and half == pytest.approx(student.ppf(0.975, 16) * 0.008**0.5)
    assert p == pytest.approx(2 * student.sf(0.8 / 0.008**0.5, 16))
    assert contrast([Sample(1.0, None, 1)], [Sample(2.0, 0.1, 3)]) == (-1.0, None, None)


def test_the_interval_holds_the_truth_as_often_as_it_says() -> None:
    random = np.random.default_rng(5)
    held = 0
    for _ in range(400):
        ours, theirs = random.normal(1.3, 0.3, (2, 4)), random.normal(1.0, 0.6, (2, 4))
        samples = [[Sample(float(x.mean()), float(x.std(ddof=1)), 4) for x in side] for side in (ours, theirs)]
        difference, half, _ = contrast(*samples)
        held += half is not None and abs(difference - 0.3) <= half
    # 95 % of 400 within three deviations of a binomial number
    assert abs(held - 380) < 3 * (400 * 0.95 * 0.05) ** 0.5


def test_what_is_asked_of_the_plant_is_no_effect() -> None:
    (factor,) = factors_of(origin())
    assert factor.name == "controller.positive.kp"
    assert factor.conditions == {name: {gain: f"{name}__{gain}" for gain in GAINS} for name in MOTIONS}
    assert factors_of(origin({"trajectory": list(MOTIONS)})) == factors_of(RunOrigin()) == []
    axes = {"payload": ["none", "brass"], "controller": ["pid", "pva"]}
    assert [one.name for one in factors_of(origin(axes))] == list(axes)


@pytest.mark.parametrize(("effect", "mark"), [(-0.5, "▼"), (0.5, "▲"), (0.0, "")])
def test_an_effect_that_was_put_in_is_found(effect: float, mark: str) -> None:
    random = np.random.default_rng(11)
    values = {
        f"{motion}__{gain}": list(random.normal(2.0 + place + effect * (gain == GAINS[1]), 0.05, 5))
        for place, motion in enumerate(MOTIONS)
        for gain in GAINS
    }
    found = effects_of(factors_of(origin()), frame(values))
    assert found["on"].to_list() == [*MOTIONS, ALL] and set(found["against"]) == {GAINS[0]}
    for row in found.iter_rows(named=True):
        assert abs(row["difference"] - effect) < 1.5 * row["half_interval_95"]
    sheet = effects_sheet(found)
    assert sheet is not None and sheet.headers == ["effect", "on", "RMSE1"]
    assert [row[-1].mark for row in sheet.rows] == [mark] * 3
    assert sheet.rows[0][0].text == "kp=0.7 against kp=1.05"
    short = effects_sheet(found, most_rows=2)
    assert short is not None and [row[1].text for row in short.rows] == [ALL] and "tables/effects.csv" in short.notes[-1]
    svg = draw_main_effects(factors_of(origin()), {"rmse1_deg": samples_of(frame(values), "rmse1_deg")})
    assert "kp 0.7" in svg and "RMSE1" in svg


def test_single_tests_tell_no_effect() -> None:
    values = {f"{motion}__{gain}": [1.0 + place] for motion in MOTIONS for place, gain in enumerate(GAINS)}
    found = effects_of(factors_of(origin()), frame(values))
    assert found.height == 0 and effects_sheet(found) is None


def test_a_condition_that_was_not_made_is_left_out() -> None:
    factor = Factor("kp", GAINS, {name: {gain: f"{name}__{gain}" for gain in GAINS} for name in MOTIONS})
    values = {"ramp__kp=1.05": [1.0, 1.1], "ramp__kp=0.7": [2.0, 2.1], "sine__kp=0.7": [3.0, 3.1]}
    assert effects_of([factor], frame(values))["on"].to_list() == ["ramp"]
