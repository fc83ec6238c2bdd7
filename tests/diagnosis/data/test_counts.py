"""What a counter shows of a path, and back."""

from __future__ import annotations

import numpy as np
import pytest

from hjcamp.diagnosis.data.counts import between_counts, counted_in_steps


@pytest.mark.parametrize("step", [0.05, 0.5])
def test_what_counts_tell_of_a_path_is_within_half_a_step_of_it(step: float) -> None:
    path = np.cumsum(np.abs(np.sin(np.arange(4000) / 300.0))) * 1e-2
    counts = counted_in_steps(path[:, None], np.array([step]), np.array([0.3]))[:, 0]
    assert np.all(np.abs(counts - path) <= 0.5 * step + 1e-9)
    again = between_counts(counts)
    assert np.all(np.abs(again - path)[10:-10] <= 0.5 * step + 1e-9)
    # between its counts it errs less than by them where it moves by less than a step in a sample
    assert np.std((again - path)[100:-100]) < 0.5 * np.std((counts - path)[100:-100])


def test_a_path_that_rests_at_one_count_or_is_not_counted_stays_as_it_is() -> None:
    assert np.array_equal(between_counts(np.full(9, 2.5)), np.full(9, 2.5))
    path = np.linspace(0.0, 1.0, 7)[:, None]
    assert np.array_equal(counted_in_steps(path, np.zeros(1), np.zeros(1)), path)
