"""Sliding is told only by blocks in which the arm mostly slides, and twins are compared where both slide."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import of_those_that_tell
from hjcamp.plants.pump_joint.diagnosis.residuals.features import BLOCK, LEAST_SLIDING, Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS

SLIDING = CHANNELS.index("sliding")
BLOCKS = 20


def features_of(sliding: NDArray[np.bool_]) -> Features:
    """Return the features of two tests of ``BLOCKS`` blocks, with these samples of steady sliding."""
    edges = np.array([0, BLOCKS * BLOCK, 2 * BLOCKS * BLOCK])
    evidence = SimpleNamespace(
        tests=(None, None),
        edges=edges,
        of_test=np.repeat([0, 1], BLOCKS * BLOCK),
        sliding=sliding,
        breakaways=np.array([7]),
        homes=np.zeros(2),
    )
    return Features(evidence)  # type: ignore[arg-type]


def slides(*blocks: range, samples: int = BLOCK) -> NDArray[np.bool_]:
    """Return the samples of sliding: the first ``samples`` of these blocks."""
    found = np.zeros(2 * BLOCKS * BLOCK, dtype=bool)
    for block in (number for one in blocks for number in one):
        found[block * BLOCK : block * BLOCK + samples] = True
    return found


def test_a_sample_at_the_onset_of_a_slip_is_no_sliding() -> None:
    assert not features_of(slides(range(40), samples=BLOCK // 2)).valid[:, SLIDING].any()
    assert features_of(slides(range(40), samples=BLOCK // 2 + 1)).valid[:, SLIDING].all()


def test_a_test_that_hardly_slides_says_nothing_of_it() -> None:
    few, enough = range(LEAST_SLIDING - 1), range(BLOCKS, BLOCKS + LEAST_SLIDING)
    features = features_of(slides(few, enough))
    assert not features.valid[:BLOCKS, SLIDING].any()
    assert features.valid[BLOCKS:, SLIDING].sum() == LEAST_SLIDING
    values = features.of(np.ones((2 * BLOCKS * BLOCK, len(CHANNELS))))
    assert not values[:BLOCKS, SLIDING].any()
    assert features.mean_square(values)[:, SLIDING] == pytest.approx([0.0, 1.0])
    assert features.valid[1, SLIDING + 1] and values[1, SLIDING + 1] != 0.0


def test_a_twin_that_slides_at_other_times_leaves_as_much_as_it_leaves_where_both_slide() -> None:
    measured = features_of(slides(range(12), range(BLOCKS, 2 * BLOCKS)))
    copied = features_of(slides(range(6, 18)))
    residuals = np.full((2 * BLOCKS * BLOCK, len(CHANNELS)), 3.0)
    shared = measured.shared(copied, copied.of(residuals))
    assert np.flatnonzero(shared[:, SLIDING]).tolist() == list(range(6, 12))
    assert measured.mean_square(shared)[:, SLIDING] == pytest.approx([9.0, 0.0])
    assert shared[:, 0] == pytest.approx(np.full(2 * BLOCKS, 3.0))


def test_a_twin_that_rests_counts_as_the_mean_of_the_others() -> None:
    logarithms = np.array([1.0, 3.0, -40.0]).reshape(3, 1, 1)
    tells = np.array([True, True, False]).reshape(3, 1, 1)
    assert of_those_that_tell(logarithms, tells).ravel() == pytest.approx([1.0, 3.0, 2.0])
    assert of_those_that_tell(logarithms, np.zeros_like(tells)).ravel() == pytest.approx([0.0, 0.0, 0.0])
