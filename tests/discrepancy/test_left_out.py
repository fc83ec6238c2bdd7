"""Intervals come from leaving one condition out after the other: exact where a model is linear."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.discrepancy.fitting.heldout import LEAST_CONDITIONS, Local

BLOCKS, UNKNOWNS = 40, 2


def local(conditions: dict[str, list[int]], residual: np.ndarray, jacobian: np.ndarray) -> Local:
    """Return a fit of one channel with this residual (blocks,) and Jacobian (unknowns, blocks)."""
    tests = sum(len(members) for members in conditions.values())
    features = SimpleNamespace(edges=np.arange(tests + 1) * BLOCKS)
    fitter = SimpleNamespace(
        features=features, rows=range(tests), views=SimpleNamespace(evidence=SimpleNamespace(conditions=conditions))
    )
    found = Local(
        cast(Any, fitter), cast(Any, SimpleNamespace(features=residual[:, None])), cast(Any, [None] * UNKNOWNS)
    )
    found.__dict__["jacobian"] = jacobian[:, :, None]
    return found


def test_a_condition_left_out_moves_a_linear_fit_as_a_new_fit_without_it() -> None:
    generator = np.random.default_rng(3)
    conditions = {str(number): [2 * number, 2 * number + 1] for number in range(LEAST_CONDITIONS)}
    rows = 2 * LEAST_CONDITIONS * BLOCKS
    design, seen = generator.standard_normal((rows, UNKNOWNS)), generator.standard_normal(rows)
    whole = np.linalg.lstsq(design, seen, rcond=None)[0]
    left = design @ whole - seen
    one = local(conditions, left, design.T)
    units = one._units()
    assert units == list(conditions.values())
    moves = one._moves(units, one.jacobian, design.T @ design)
    for tests, move in zip(units, moves, strict=True):
        kept = np.repeat(~np.isin(np.arange(2 * LEAST_CONDITIONS), tests), BLOCKS)
        again = np.linalg.lstsq(design[kept], seen[kept], rcond=None)[0]
        assert move == pytest.approx(again - whole, rel=1e-9)


def test_with_few_conditions_each_test_is_left_out() -> None:
    one = local({"a": [0, 1, 2], "b": [3, 4]}, np.zeros(1), np.zeros((UNKNOWNS, 1)))
    assert one._units() == [[0], [1], [2], [3], [4]]
