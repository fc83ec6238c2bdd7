"""Two laws that do the same differ by where their fits ended, alike in each block: neither rules the other out."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.estimation.gauss_newton import SETTLED
from hjcamp.diagnosis.selection.search import Search
from hjcamp.diagnosis.validation.blocks import critical


@pytest.mark.parametrize(("more", "beaten"), [(1e-6, False), (1e-4, False), (0.1, True)])
def test_a_model_that_is_better_by_less_than_fits_leave_rules_nothing_out(more: float, beaten: bool) -> None:
    features = np.random.default_rng(6).standard_normal((96, 8)) * 3.0
    model, other = (
        SimpleNamespace(features=one, fitted=SimpleNamespace(features=one), left_out=3.0)
        for one in (features, features * (1.0 + more))
    )
    claims: Any = SimpleNamespace(blocks=np.repeat(np.arange(16), 6))
    claims.t = lambda one, two: Search.t(claims, one, two)
    t, count = claims.t(model, other)
    assert t > critical(count)
    assert Search.beats(claims, model, other) == beaten  # type: ignore[arg-type]
    # in all as a share of 768 coefficients
    assert (96 * 8 * more > SETTLED) == beaten
