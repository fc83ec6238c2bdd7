"""Which effects a step cannot tell apart, beside those that other steps have taken."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from hjcamp.plants.pump_joint.diagnosis.screening.screening import Step
from hjcamp.plants.pump_joint.diagnosis.selection.verdict import rivals_of, weighed


def step(**weights: float) -> Step:
    return cast(Any, SimpleNamespace(weights=weights, best=next(iter(weights)), fits=dict.fromkeys(weights)))


def looked_at(about: float, losses: dict[str, float], weights: dict[str, float]) -> Step:
    fits: Any = {name: SimpleNamespace(loss=loss) for name, loss in losses.items()}
    return Step(cast(Any, SimpleNamespace(about=SimpleNamespace(loss=about))), fits, weights, 0.01, np.zeros(1))


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


@pytest.mark.parametrize(("beside", "rivals"), [(18.0, []), (27.0, ["stribeck_friction", "position_friction"])])
def test_what_gains_as_much_beside_the_best_one_is_no_rival(beside: float, rivals: list[str]) -> None:
    first = looked_at(
        40.0,
        {"stribeck_friction": 28.0, "position_friction": 28.5},
        {"stribeck_friction": 0.6, "position_friction": 0.4},
    )
    about: Any = SimpleNamespace(about=first.fits["stribeck_friction"])
    second = Step(
        about,
        {"position_friction": cast(Any, SimpleNamespace(loss=beside))},
        {"position_friction": 1.0},
        0.5,
        np.zeros(1),
    )
    assert rivals_of(first, [first], [first, second]) == rivals
    assert rivals_of(first, [first], [first]) == ["stribeck_friction", "position_friction"]


@pytest.mark.parametrize(
    ("found", "verdict", "named", "undecided"),
    [
        ([("leakage", [])], "effect", ["leakage"], ()),
        ([("leakage", []), ("encoder_lag", [])], "effect", ["leakage", "encoder_lag"], ()),
        (
            [("leakage", ["leakage", "tubing_creep"])],
            "one_of",
            ["leakage", "tubing_creep"],
            ("leakage", "tubing_creep"),
        ),
        ([("leakage", []), ("encoder_lag", ["a", "b"])], "effect", ["leakage"], ("a", "b")),
        ([("leakage", ["a", "b"]), ("encoder_lag", [])], "one_of", ["a", "b"], ("a", "b")),
    ],
    ids=["one", "two", "one of two", "beside a certain one", "beside a lesser certain one"],
)
def test_what_is_certain_is_named(
    found: list[tuple[str, list[str]]], verdict: str, named: list[str], undecided: tuple[str, ...]
) -> None:
    said = weighed(found)
    assert (said.verdict, said.effects, said.undecided) == (verdict, named, undecided)
    certain = [best for best, rivals in found if not rivals]
    assert not undecided or all(name in said.reason or name in said.effects for name in certain)
