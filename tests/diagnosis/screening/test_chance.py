"""What chance promises: of residuals moved in time, of decoys, of residuals drawn at random."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.estimation.gauss_newton import Fitted
from hjcamp.diagnosis.screening.chance import chance_gains, moved_orders, p_value
from hjcamp.diagnosis.screening.screening import Probe, Projection
from hjcamp.model.declare.candidate import Candidate

WINDOWS, D, ORDERS = 160, 3, 99


def projection_of(features: Any) -> Projection:
    return Projection(Fitted(Candidate({}, {}), (), features, np.zeros((*features.shape, 0)), 0.0))


def library(responses: Any) -> list[Probe]:
    # two probes of each effect, the second a little off the first
    return [
        Probe(f"effect{k // 2}", {}, ("size",), np.ones(1), False, responses[:, :, k : k + 1])
        for k in range(responses.shape[2])
    ]


def drawn(seed: int, hidden: float) -> tuple[Any, list[Probe], list[Any]]:
    """Return white features with ``hidden`` times the response of the third effect, a library of four, and orders."""
    generator = np.random.default_rng(seed)
    responses = generator.standard_normal((WINDOWS, D, 8))
    responses[:, :, 1::2] = responses[:, :, ::2] + 0.3 * responses[:, :, 1::2]
    features = 5.0 * (generator.standard_normal((WINDOWS, D)) - hidden * responses[:, :, 4])
    orders = moved_orders(np.zeros(WINDOWS, dtype=np.int64), generator.standard_normal((WINDOWS, 4)), seed, ORDERS)
    return projection_of(features), library(responses), orders


def test_what_is_there_stands_out_of_all_that_chance_promises() -> None:
    found = chance_gains(*drawn(3, 0.5), seed=1)
    for gains in (found.shifted, found.decoys, found.replicates):
        assert len(gains) == ORDERS and gains.max() < 0.7 * found.gain
    assert p_value(found.gain, found.shifted) == 0.01
    # moved responses are the same responses: each decoy's gain is one that a moved residual has with some effect
    assert np.median(found.decoys) == pytest.approx(np.median(found.shifted), rel=0.4)


def test_where_nothing_is_chance_promises_as_much_as_it_should() -> None:
    shares = {"shifted": [], "decoys": [], "replicates": []}  # type: dict[str, list[float]]
    for seed in range(60):
        found = chance_gains(*drawn(seed, 0.0), seed=seed)
        for name, values in shares.items():
            values.append(float(np.mean(getattr(found, name) >= found.gain)))
    for name, values in shares.items():
        # uniform: mean 1/2 within three standard errors, and both ends are reached
        assert np.mean(values) == pytest.approx(0.5, abs=3.0 * 0.29 / np.sqrt(60)), name
        assert min(values) < 0.15 and max(values) > 0.85, name


def test_the_same_seed_draws_the_same() -> None:
    one, again, other = (chance_gains(*drawn(5, 0.1), seed=seed) for seed in (2, 2, 3))
    assert np.array_equal(one.replicates, again.replicates) and np.array_equal(one.decoys, again.decoys)
    assert not np.array_equal(one.replicates, other.replicates) and np.array_equal(one.shifted, other.shifted)
