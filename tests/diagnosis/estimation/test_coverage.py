"""How often 95 % intervals hold the truth: on windows of a known law, independent or repeating each other within a block."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.diagnosis.estimation.gauss_newton import Free, fit
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.estimation.profile import profiles
from hjcamp.model.declare.candidate import Candidate

TRUTH, DRAWS, WINDOWS, FEATURES = {"decay": 1.5, "gain": 0.5}, 100, 64, 3
FREE = (Free("", "decay", 1.0, 0.0, 10.0), Free("", "gain", 1.0, -10.0, 10.0))


def made(seed: int, blocks: int, shared: float, noise: float) -> Any:
    """Return windows of 20 exp(-decay x) + 6 gain z, with noise of which a part is ``shared`` by the windows of a block."""
    chance = np.random.default_rng(seed)
    of = np.arange(WINDOWS) * blocks // WINDOWS
    x, z = chance.uniform(0.2, 2.0, (WINDOWS, FEATURES)), chance.standard_normal((WINDOWS, FEATURES))
    own, common = (chance.standard_normal((count, FEATURES)) for count in (WINDOWS, blocks))

    def law(base: Any) -> np.ndarray:
        return 20.0 * np.exp(-base["decay"] * x) + 6.0 * base["gain"] * z

    read = law(TRUTH) + noise * (np.sqrt(1.0 - shared) * own + np.sqrt(shared) * common[of])
    return SimpleNamespace(place=None, blocks=of, along=lambda candidate: read - law(candidate.base))


@pytest.mark.parametrize(("blocks", "shared", "noise"), [(16, 0.0, 1.0), (8, 0.5, 3.0)])
def test_intervals_by_likelihood_ratio_and_by_curvature_hold_the_truth_in_95_of_a_hundred(
    blocks: int, shared: float, noise: float
) -> None:
    held = np.zeros((2, 2))
    for seed in range(DRAWS):
        windows = made(seed, blocks, shared, noise)
        fitted = fit(windows, Candidate({"decay": 1.2, "gain": 0.3}, {}), FREE)
        names = {("", one) for one in TRUTH}
        for row, found in enumerate((intervals(fitted, windows.blocks), profiles(windows, fitted, windows.blocks, names))):
            for column, (one, truth) in enumerate(zip(found, TRUTH.values(), strict=True)):
                held[row, column] += one.low is not None and one.high is not None and one.low <= truth <= one.high
    curvature, ratio = held.mean(axis=1) / DRAWS
    # 200 intervals of estimates that hardly depend on each other: two standard deviations; the quadratic has few blocks against it
    assert abs(ratio - 0.95) <= 0.031 and abs(curvature - 0.95) <= 0.045, held
