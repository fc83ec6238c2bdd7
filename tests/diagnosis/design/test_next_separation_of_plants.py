"""Separation: nothing where a refit explains all, all where the tests so far hold the parameters, more for larger differences."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.diagnosis.design.rivals import sets_of
from hjcamp.diagnosis.design.separation import Contest, deviate

D, COUNT = 8, 40
GENERATOR = np.random.default_rng(5)
NOISE = GENERATOR.standard_normal((400, D))


def contest(differences: np.ndarray, slopes: np.ndarray, held: float) -> Contest:
    return Contest(differences, slopes, held * np.eye(slopes.shape[2]), NOISE, np.repeat([0, 1], COUNT // 2))


def test_what_a_refit_explains_does_not_separate() -> None:
    slopes = GENERATOR.standard_normal((COUNT, D, 2))
    along = slopes @ np.array([3.0, -2.0])
    assert contest(along, slopes, 1e-12).separation([0, 1]) < 1e-3
    # what the tests so far hold cannot be refitted
    assert contest(along, slopes, 1e9).separation([0, 1]) == pytest.approx(deviate(along, NOISE), rel=1e-3)


def test_parameters_that_each_test_would_move_elsewhere_are_told_by_both_together() -> None:
    slopes = np.ones((COUNT, D, 1))
    differences = np.repeat([1.5, -1.5], COUNT // 2)[:, None] * np.ones(D)
    one = contest(differences, slopes, 1e-12)
    assert one.separation([0]) < 1e-3 and one.separation([1]) < 1e-3
    assert one.separation([0, 1]) > 3.0


@pytest.mark.parametrize("size", [0.05, 0.2])
def test_small_differences_have_the_deviate_of_a_likelihood_ratio(size: float) -> None:
    # one constant difference of Gaussian features: mean |z|^2 / 2, standard deviation |z|, but for the heavy tails
    left = np.full((COUNT, D), size)
    expected = 0.5 * np.sqrt(np.sum(left**2))
    assert deviate(left, NOISE) == pytest.approx(expected, abs=0.5 * expected + 0.4)
    assert deviate(3.0 * left, NOISE) > deviate(left, NOISE)
    assert deviate(np.zeros((COUNT, D)), NOISE) == 0.0


def test_what_a_refit_costs_on_measured_tests_counts() -> None:
    left = np.full((COUNT, D), 0.2)
    assert deviate(left, NOISE, worse=10.0) > deviate(left, NOISE) + 1.0


def test_names_that_are_not_ruled_out_are_rivals_of_the_law_that_is_outside() -> None:
    rows = [{"effect": name, "heldout_error_ratio": 0.4} for name in ("spring", "soft_stop", "leakage")]
    laws = [{"law": "unknown_force_over_position"}]
    answer = {"verdict": "outside_library", "effects": [], "confidence_set": [["spring"]], "candidates": rows, "unknowns": laws}
    assert sets_of(answer) == [("spring",), ("unknown_force_over_position",), ("soft_stop",)]
    assert sets_of({**answer, "confidence_set": []})[0] == ("unknown_force_over_position",)


def test_where_tests_cannot_tell_what_takes_most_stands_against_nothing() -> None:
    rows = [
        {"effect": name, "heldout_error_ratio": left}
        for name, left in (("leakage", 0.98), ("overflow", 0.7), ("sensor_lag", 0.4))
    ]
    answer = {"verdict": "cannot_tell", "effects": [], "confidence_set": [[]], "candidates": rows, "unknowns": []}
    assert sets_of(answer) == [(), ("sensor_lag",), ("overflow",)]
    # what would not stand out is looked at where no effect takes anything
    assert sets_of({**answer, "candidates": rows[:1]}) == []
