"""The evidence of a diagnosis: what chance stays within, and pictures that say what they show."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.report.pictures.evidence import (
    BACKWARD,
    BOTH,
    FORWARD,
    Branch,
    Missing,
    draw_correlations,
    draw_gains,
    draw_missing,
    draw_worst_test,
)
from hjcamp.report.tables.correlations import correlations, of_repetitions, unshared

PERIOD, LATE = 0.01, 7
GENERATOR = np.random.default_rng(7)
NOISE, OTHER = GENERATOR.normal(size=(2, 4000))
PARTS = [slice(0, 1500), slice(1500, 4000)]


def test_white_noise_stays_in_its_band_but_for_one_value_in_twenty() -> None:
    own, crossed = correlations(NOISE, {"voltage": OTHER}, PARTS, PERIOD)
    assert own.values[0] == pytest.approx(1.0) and own.lags[1] == PERIOD
    assert np.mean(np.abs(own.values[1:]) > own.band[1:]) < 0.12
    assert np.mean(np.abs(crossed.values) > crossed.band) < 0.12


def test_what_follows_an_input_is_seen_at_its_delay_and_sign() -> None:
    follows = NOISE - 0.8 * np.concatenate([np.zeros(LATE), OTHER[:-LATE]])
    _, crossed = correlations(follows, {"voltage": OTHER}, PARTS, PERIOD)
    assert np.argmax(np.abs(crossed.values)) == LATE
    assert crossed.values[LATE] == pytest.approx(-0.8 / np.sqrt(1.0 + 0.8**2), abs=0.05)
    assert abs(crossed.values[LATE]) > 5.0 * crossed.band[LATE]


def test_slow_signals_that_have_nothing_to_do_with_each_other_have_a_wide_band() -> None:
    smooth = np.exp(-np.arange(200) / 30.0)
    slow, also = np.convolve(NOISE, smooth, "same"), np.convolve(OTHER, smooth, "same")
    _, crossed = correlations(slow, {"voltage": also}, PARTS, PERIOD)
    assert np.all(np.abs(crossed.values) < crossed.band)
    assert crossed.band[0] > 3.0 * 1.96 / np.sqrt(4000)  # white noise's band would call it an input


def test_an_input_that_never_changes_and_a_short_test_are_no_trouble() -> None:
    found = correlations(NOISE[:9], {"voltage": np.ones(9)}, [slice(0, 9)], PERIOD)
    assert len(found) == 1 and len(found[0].lags) == 5
    assert np.all(correlations(np.zeros(50), {}, [slice(0, 50)], PERIOD)[0].values == 0.0)


@pytest.mark.parametrize(("scatter", "shared"), [(1.0, 0.0), (1.0, 3.0), (0.2, 5.0)])
def test_what_repetitions_do_not_share_has_the_size_and_colour_of_their_scatter(scatter: float, shared: float) -> None:
    smooth = np.exp(-np.arange(40) / 8.0)
    smooth /= np.sqrt(np.sum(smooth**2))
    repetitions = [scatter * np.convolve(one, smooth, "same") for one in NOISE.reshape(4, 1000)]
    law = shared * np.sin(np.arange(1000) / 40.0)
    residual = np.concatenate([law + one for one in repetitions])
    tests = [[slice(1000 * k, 1000 * (k + 1)) for k in range(4)], [slice(0, 1000)]]
    apart, rows, parts = unshared(residual, tests)
    assert np.std(apart) == pytest.approx(scatter, rel=0.1) and len(parts) == 4 and np.array_equal(rows, np.arange(4000))
    [own] = of_repetitions(residual, {}, tests, PERIOD)
    assert own.values[8] == pytest.approx(np.exp(-1.0), abs=0.1)


def test_without_repetitions_nothing_is_said_of_them() -> None:
    assert of_repetitions(NOISE, {"voltage": OTHER}, [[one] for one in PARTS], PERIOD) == []
    found = correlations(NOISE, {"voltage": OTHER}, PARTS, PERIOD)
    drawn = draw_correlations([("calibrated", found)], of_repetitions(NOISE, {"voltage": OTHER}, [PARTS], PERIOD))
    assert all("between repetitions" in svg for svg in drawn.values())
    assert "between repetitions" not in "".join(draw_correlations([("calibrated", found)]).values())


def missing(law: bool) -> Missing:
    """Return a spring over an angle, both ways, with the law and what is left where there is one."""
    x = np.linspace(-1.0, 1.0, 12)
    before = tuple(Branch(way, x, -2.0 * x + lift) for way, lift in ((FORWARD, -0.3), (BACKWARD, 0.3)))
    line = (Branch(BOTH, x, -2.0 * x, -2.2 * x, -1.8 * x),)
    left = (Branch(BOTH, x, np.where(x > 0.5, np.nan, 0.0)),)
    return Missing("arm angle", "rad", "missing force", "N", before, line if law else (), left if law else (), "spring")


def test_the_missing_quantity_is_drawn_both_ways_with_the_law_through_it() -> None:
    pictures = draw_missing(missing(law=True))
    assert list(pictures) == ["before", "after"]
    assert all(
        said in pictures["before"] for said in ("arm angle (deg)", "missing force (N)", "forwards", "backwards", "spring")
    )
    assert "missing: with spring" in pictures["after"] and "nan" not in pictures["after"]
    assert list(draw_missing(missing(law=False))) == ["before"]


def test_gains_worst_test_and_correlations_name_their_curves() -> None:
    time = np.arange(50) * PERIOD
    assert "these tests" in draw_gains(NOISE[:40], 9.0, "twins") and "chance: twins" in draw_gains(NOISE[:40], None, "twins")
    assert "these tests" not in draw_gains(NOISE[:40], None, "twins")
    worst = draw_worst_test(
        "worst test: ramp/1", "arm angle", "deg", time, time, [("calibrated", time), ("with leakage", time)]
    )
    assert all(said in worst for said in ("worst test: ramp/1", "measured", "calibrated", "with leakage", "residual"))
    found = correlations(NOISE, {"voltage": OTHER}, PARTS, PERIOD)
    drawn = draw_correlations([("calibrated", found)])
    assert list(drawn) == ["correlation_1", "correlation_2"] and "with voltage before" in drawn["correlation_2"]
