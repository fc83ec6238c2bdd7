"""From how many starts an effect is fitted, and over which strengths it is probed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.plants.pump_joint.diagnosis.screening.responses import shapes, strength_is_a_shape
from hjcamp.plants.pump_joint.diagnosis.screening.screening import starts_of

LIBRARY = load_effects([])


def screened(name: str, probes: int) -> Any:
    return SimpleNamespace(instead={}, ranked={name: [None] * probes})


@pytest.mark.parametrize(
    ("name", "starts"),
    [
        ("stribeck_friction", [(0,), (1,), (2,)]),
        ("pump_backlash", [(0,), (1,), (2,)]),
        ("leakage", [(0, 1, 2)]),
        ("presliding", [(0, 1, 2)]),
    ],
)
def test_a_strength_that_is_a_shape_is_fitted_from_several_valleys(name: str, starts: list[tuple[int, ...]]) -> None:
    assert starts_of(screened(name, 9), LIBRARY[name]) == starts
    assert strength_is_a_shape(LIBRARY[name]) == (len(starts) > 1)


def test_there_are_no_more_starts_than_probes() -> None:
    assert starts_of(screened("stribeck_friction", 2), LIBRARY["stribeck_friction"]) == [(0,), (1,)]


@pytest.mark.parametrize("name", ["stribeck_friction", "pump_backlash"])
def test_strengths_stand_less_than_twice_apart(name: str) -> None:
    strengths = np.sort([next(iter(shape.values())) for shape in shapes(LIBRARY[name])])
    assert np.all(strengths[1:] / strengths[:-1] < 2.0)
