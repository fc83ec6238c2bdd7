"""Intervals come from leaving one condition out after the other: exact where a model is linear."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.parameter import Parameter
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.answers.corner import fitted_parameters
from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import LEAST_CONDITIONS, Local
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import Unknown

BLOCKS, UNKNOWNS = 40, 2


def local(conditions: dict[str, list[int]], residual: np.ndarray, jacobian: np.ndarray) -> Local:
    """Return a fit of one channel with this residual (blocks,) and Jacobian (unknowns, blocks)."""
    tests = sum(len(members) for members in conditions.values())
    features = SimpleNamespace(edges=np.arange(tests + 1) * BLOCKS)
    fitter = SimpleNamespace(
        features=features, rows=range(tests), views=SimpleNamespace(evidence=SimpleNamespace(conditions=conditions))
    )
    found = Local(cast(Any, fitter), cast(Any, SimpleNamespace(features=residual[:, None])), cast(Any, [None] * UNKNOWNS))
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


def test_the_curvature_and_errors_in_si_of_a_linear_fit() -> None:
    generator = np.random.default_rng(5)
    conditions = {str(number): [number] for number in range(LEAST_CONDITIONS)}
    design = generator.standard_normal((LEAST_CONDITIONS * BLOCKS, 2))
    design[:, 1] += 3.0 * design[:, 0]
    law, plain = PumpJoint.parameters["moving_mass"], Parameter("m", 0.5, (0.0, 9.0), text="a length", off=0.0)
    one = local(conditions, 0.1 * generator.standard_normal(len(design)), design.T)
    one = replace(one, unknowns=[Unknown("", "moving_mass", law), Unknown("spring", "length", plain)])
    one.__dict__["jacobian"] = design.T[:, :, None]
    one.fitter.weights = lambda mean_square: 1.0  # type: ignore[method-assign,assignment,misc,return-value]
    candidate = Candidate({"moving_mass": 0.02}, {"spring": {"length": 1.5}})
    object.__setattr__(one, "fit", SimpleNamespace(features=one.fit.features, mean_square=None, candidate=candidate))
    assert one.covariance == pytest.approx(np.linalg.inv(design.T @ design), rel=1e-4)
    estimates, correlation = fitted_parameters(one)
    by_hand = np.linalg.inv(design.T @ design)
    assert correlation[0, 1] == pytest.approx(by_hand[0, 1] / np.sqrt(by_hand[0, 0] * by_hand[1, 1]), rel=1e-3)
    assert correlation[0, 1] < -0.9
    # an interval's half width is so many standard errors, on the scale on which it is fitted
    wide = 2.7764  # Student's t, 4 degrees of freedom, 97.5 %
    first, second = estimates
    assert first.error / first.value == pytest.approx(np.log(first.ci95[1] / first.ci95[0]) / (2 * wide), rel=1e-3)
    assert second.error == pytest.approx((second.ci95[1] - second.ci95[0]) / (2 * wide), rel=1e-3)
    assert (first.label, second.label, second.unit) == ("moving mass", "spring length", "m")
