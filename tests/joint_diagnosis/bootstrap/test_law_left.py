"""What a law leaves is told where it is more than twins may leave."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.answer_rows import law_left
from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import Null

TESTS, CHANNELS, TWINS = 12, 7, 40


def test_the_share_is_that_of_the_error_above_what_twins_may_leave() -> None:
    logarithms = 0.2 * np.random.default_rng(1).standard_normal((TWINS, TESTS, CHANNELS))
    null = Null(np.ones(TWINS), logarithms, np.ones((TESTS, CHANNELS), dtype=bool), np.zeros(CHANNELS))
    like, high = np.exp(logarithms.mean(axis=0)), float(null.highest()[2])

    def left(before: float, after: float) -> float:
        base, fit = (like.copy() for _ in range(2))
        base[:, 2] *= before**2
        fit[:, 2] *= after**2
        found: Any = SimpleNamespace(null=null, baseline=SimpleNamespace(mean_square=base))
        return law_left(found, SimpleNamespace(mean_square=fit))  # type: ignore[arg-type]

    assert 1.0 < high < 1.2
    assert left(9.0, 3.0) == pytest.approx((3.0**2 - high**2) / (9.0**2 - high**2))
    assert left(9.0, 9.5) == 1.0 and left(9.0, 1.0) == 0.0
    # a weak effect: chance leaves as much as either
    assert left(0.99 * high, 1.0) == 0.0
