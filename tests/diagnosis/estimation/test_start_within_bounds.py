"""A fit begins within the bounds of its parameters, so that no interval has its ends the wrong way round."""

from __future__ import annotations

import pytest

from hjcamp.diagnosis.estimation.gauss_newton import Free
from hjcamp.model.declare.candidate import Candidate


@pytest.mark.parametrize(("value", "found"), [(1e-3, 0.5), (0.7, 0.7), (9.0, 2.0)])
@pytest.mark.parametrize("log", [False, True])
def test_a_start_beyond_a_bound_is_moved_onto_it(value: float, found: float, log: bool) -> None:
    free = Free("overflow", "spill", 1.0, 0.5, 2.0, log)
    candidate = Candidate({}, {"overflow": {"spill": value, "brim": 3.0}})
    assert free.within(candidate).effects["overflow"] == {"spill": pytest.approx(found), "brim": 3.0}
    assert (free.within(candidate) is candidate) == (value == found)


def test_the_base_too() -> None:
    free = Free("", "mass", 1.0, 1.0, 10.0)
    assert free.within(Candidate({"mass": 0.1}, {})).base == {"mass": 1.0}
