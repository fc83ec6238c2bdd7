"""The choice by nested cross-validation and a confidence set, on linear toys whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.diagnosis.choice.comparison_of_models import confidence_set, flips_of, nested_choice, not_worse
from hjcamp.diagnosis.choice.subsets import Blocks, Column, best_settings, kept_by_blocks, pairs_of
from hjcamp.diagnosis.validation.blocks import chance_of_t, ratio_t

BLOCKS, ROWS = 8, 40


def toy(random: np.random.Generator, effects: dict[int, float], names: int = 20) -> tuple[Blocks, list[Column]]:
    """Return the moments of white residuals in which some of ``names`` effects act, each with a response of its own."""
    count = BLOCKS * ROWS
    slopes, responses = random.normal(size=(count, 3)), random.normal(size=(count, names))
    residuals = random.normal(size=count) - 0.4 * slopes[:, 0]
    for place, size in effects.items():
        residuals -= size * responses[:, place]
    columns = [Column(f"effect_{k}", k, responses[:, [k]]) for k in range(names)]
    return Blocks(residuals, slopes, np.zeros((3, 3)), columns, np.repeat(np.arange(BLOCKS), ROWS)), columns


def test_the_score_of_a_block_is_that_of_a_fit_without_it() -> None:
    """The independent computation: least squares on all other blocks, then the residuals of the block."""
    random = np.random.default_rng(4)
    slopes, response = random.normal(size=(60, 2)), random.normal(size=(60, 1))
    residuals, blocks = random.normal(size=60) - response[:, 0], np.repeat(np.arange(6), 10)
    [found] = Blocks(residuals, slopes, np.zeros((2, 2)), [Column("a", 0, response)], blocks).ranked([(0,)])
    for b in range(6):
        out, left = blocks == b, []
        for columns in (slopes, np.hstack([slopes, response])):
            fit = np.linalg.lstsq(columns[~out], -residuals[~out], rcond=None)[0]
            left.append(np.sum((residuals[out] + columns[out] @ fit) ** 2))
        assert found.scores[b] == pytest.approx(5.0 * np.log(left[0] / left[1]), rel=1e-6)


def test_the_gate_holds_its_level_where_nothing_is_missing() -> None:
    """Of 120 toys without an effect, twenty candidates and all their pairs, as many are claimed at 5 % as its interval allows."""
    random, claimed = np.random.default_rng(70), 0
    for _ in range(120):
        moments, columns = toy(random, {})
        singles = moments.ranked([(k,) for k in range(len(columns))])
        pairs = moments.ranked(pairs_of(best_settings(singles, columns, 1), columns, lambda a, b: True))
        kept = kept_by_blocks(((singles, 2), (pairs, 2)), BLOCKS)
        scores = {one.columns: one.scores for one in (*singles, *pairs)}
        each = np.array([scores[one] for one in kept])
        choice = nested_choice(each, np.array([[b in blocks for b in range(BLOCKS)] for blocks in kept.values()]))
        gained = np.array([each[k, b] if k >= 0 else 0.0 for b, k in enumerate(choice)])
        t, count = ratio_t(gained, np.ones(BLOCKS))
        claimed += t > 0.0 and chance_of_t(t, count) < 0.05
    assert claimed <= 11  # 95 % of draws at 5 % lie below


def test_a_pair_is_found_though_neither_of_it_is_the_best_alone() -> None:
    random = np.random.default_rng(5)
    moments, columns = toy(random, {3: 0.5, 11: -0.5})
    singles = moments.ranked([(k,) for k in range(len(columns))])
    pairs = moments.ranked(pairs_of(best_settings(singles, columns, 1), columns, lambda a, b: True))
    assert max(pairs, key=lambda one: one.scores.sum()).columns == (3, 11)
    assert (3, 11) in kept_by_blocks(((singles, 1), (pairs, 1)), BLOCKS)


def test_a_sign_that_bounds_forbid_is_no_candidate() -> None:
    random = np.random.default_rng(6)
    count = BLOCKS * ROWS
    response = random.normal(size=(count, 1))
    residuals = random.normal(size=count) + response[:, 0]  # asks for a negative amplitude
    moments = Blocks(
        residuals,
        np.zeros((count, 0)),
        np.zeros((0, 0)),
        [Column("bounded", 0, response, one_sided=True), Column("free", 1, response)],
        np.repeat(np.arange(BLOCKS), ROWS),
    )
    assert [one.columns for one in moments.ranked([(0,), (1,)])] == [(1,)]


def advantages_of(scores: np.ndarray) -> np.ndarray:
    """Return the advantages (models, models, blocks) of models over each other by their scores (models, blocks)."""
    return np.asarray(scores[:, None] - scores[None])


def test_the_confidence_set_keeps_the_best_model_and_drops_what_is_clearly_worse() -> None:
    """The best of four models is lost in no more than the level allows; one that is far behind goes."""
    random, lost, kept_far = np.random.default_rng(7), 0, 0
    for _ in range(60):
        scores = random.normal(0.0, 2.0, size=(4, 10)) + np.array([[3.0], [3.0], [2.5], [-8.0]])
        left = confidence_set(advantages_of(scores), np.ones((4, 4, 10)), 0.05)
        lost += 0 not in left
        kept_far += 3 in left
    assert lost <= 7 and kept_far == 0


def test_all_flips_are_taken_where_they_are_few() -> None:
    assert len(np.unique(flips_of(6), axis=0)) == 64
    assert flips_of(14).shape == (2000, 14) and np.all(flips_of(14)[0] == 1.0)


def test_the_simplest_that_suffices_errs_as_little_as_the_best_in_every_sensor() -> None:
    # shares of what lies above repeatability, by channel
    assert not_worse([np.array([0.1, 0.2]), np.array([0.15, 0.29]), np.array([0.1, 0.31])], 0.10) == [0, 1]
    assert not_worse([np.array([0.1, 0.25]), np.array([0.25, 0.1])], 0.10) == []  # each is best in another channel


def test_columns_of_which_the_base_leaves_rounding_alone_can_be_ranked() -> None:
    chance = np.random.default_rng(5)
    slopes, residuals = chance.standard_normal((240, 2)), chance.standard_normal(240)
    columns = [Column(name, k, slopes[:, k : k + 1]) for k, name in enumerate("ab")]
    moments = Blocks(residuals, slopes, np.zeros((2, 2)), columns, np.arange(240) // 20)
    for k, one in enumerate(moments.others):  # as rounding may leave them: nothing of either, and a part that both share
        one[1, 1] = one[2, 2] = -1e-13 * k
        one[1, 2] = one[2, 1] = one[0, 1] = one[1, 0] = 1e-13
    for found in moments.ranked([(0,), (1,), (0, 1)]):
        assert np.all(np.abs(found.scores) < 1e-2)
