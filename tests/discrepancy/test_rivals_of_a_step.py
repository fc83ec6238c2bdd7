"""Which effects a step cannot tell apart, beside those that other steps have taken."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from hjcamp.discrepancy.search import Step
from hjcamp.discrepancy.verdict import rivals_of


def step(**weights: float) -> Step:
    return cast(Any, SimpleNamespace(weights=weights, best=next(iter(weights))))


@pytest.mark.parametrize(
    ("weights", "rivals"),
    [
        ({"leakage": 1.0}, []),
        ({"leakage": 0.85, "tubing_creep": 0.15}, []),
        ({"leakage": 0.6, "tubing_creep": 0.4}, ["leakage", "tubing_creep"]),
        ({"leakage": 0.5, "entrained_air": 0.45, "tubing_creep": 0.05}, ["leakage", "entrained_air"]),
    ],
)
def test_rivals_are_those_with_a_tenth_of_the_weight(weights: dict[str, float], rivals: list[str]) -> None:
    one = step(**weights)
    assert rivals_of(one, [one]) == rivals


def test_an_effect_that_another_step_has_taken_is_no_rival() -> None:
    first, second = step(leakage=1.0), step(payload_inertia=0.5, leakage=0.5)
    assert rivals_of(second, [first, second]) == []
