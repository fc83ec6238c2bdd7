"""A pattern search leaves the ripples of slips behind in which a derivative sticks."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.fitting.pattern_search import settle
from hjcamp.plants.pump_joint.diagnosis.models.unknowns import base_unknowns, read, written
from hjcamp.workers.pool import Crew

UNKNOWNS = base_unknowns(["viscous_positive", "line_stiffness"])
BEST = np.array([3.0, 30.5])
RIPPLE, WAVES = 1.0, 90.0


class Rough:
    """A fitter whose loss is a bowl about `BEST` with ripples, each deep enough to hold a gradient step."""

    def __init__(self, workers: int = 1) -> None:
        self.crew = Crew(workers)
        self.looks = 0

    def look(self, candidate: Candidate) -> Any:
        self.looks += 1
        away = read(candidate, UNKNOWNS) - BEST
        loss = float(100.0 * away @ away + RIPPLE * np.sum(1.0 - np.cos(WAVES * away)))
        return SimpleNamespace(candidate=candidate, loss=loss, mean_square=np.ones((1, 1)))

    def jacobian(self, at: Any, unknowns: Any) -> Any:
        return np.full((len(unknowns), 1, 1), 10.0)

    def weights(self, mean_square: Any) -> Any:
        return np.ones((1, 1))


def start() -> Candidate:
    return written(Candidate({}), UNKNOWNS, BEST + np.array([-0.3, 0.4]))


def test_it_comes_down_to_the_last_ripples() -> None:
    fitter = Rough()
    begin = fitter.look(start())
    found = settle(fitter, begin, UNKNOWNS, 20)  # type: ignore[arg-type]
    assert begin.loss > 20.0
    assert found.loss < 2 * RIPPLE
    assert np.allclose(read(found.candidate, UNKNOWNS), BEST, atol=0.1)


@pytest.mark.parametrize("sweeps", [0, 1, 3])
def test_it_never_loses_and_ends_after_its_sweeps(sweeps: int) -> None:
    fitter = Rough()
    begin = fitter.look(start())
    found = settle(fitter, begin, UNKNOWNS, sweeps)  # type: ignore[arg-type]
    assert found.loss <= begin.loss
    assert (found is begin) == (sweeps == 0)
    assert fitter.looks <= 1 + 2 * len(UNKNOWNS) * sweeps


def test_it_finds_the_same_with_two_workers() -> None:
    one, two = Rough(1), Rough(2)
    alone = settle(one, one.look(start()), UNKNOWNS, 6)  # type: ignore[arg-type]
    both = settle(two, two.look(start()), UNKNOWNS, 6)  # type: ignore[arg-type]
    two.crew.close()
    assert alone.candidate == both.candidate
