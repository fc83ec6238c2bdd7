"""The zero of a position's scale decides nothing: a spring is found where it is, with the same stiffness, wherever that is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from carriage import measured_log

from hjcamp.analyses.diagnosing import Asked, diagnose_plant
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.effects import load_effects
from hjcamp.errors import UsageError
from hjcamp.known_plants import plant_called

SPRING, REST = 140.0, 0.02


@pytest.mark.parametrize("zero", [-10.0, *(pytest.param(zero, marks=pytest.mark.study) for zero in (0.0, 0.3, 1.0))])
def test_the_zero_of_a_scale_decides_nothing(axis: Path, zero: float) -> None:
    log = measured_log(force=lambda x, v: -SPRING * (x - REST), seconds=6.0, noise=2e-6)
    log = replace(log, columns={**log.columns, "position_m": log.columns["position_m"] + zero})
    data: Any = SimpleNamespace(measured=measured_tests([log]), logs=[log])
    found = diagnose_plant(data, Asked(effort="quick", only="spring,constant_force,quadratic_drag"))
    assert found.content["verdict"] == "effect" and found.content["effects"] == ["spring"]
    spring = found.verdict.model.fitted.candidate.effects["spring"]
    assert spring["stiffness"] == pytest.approx(SPRING, rel=0.03)
    assert spring["rest_position"] == pytest.approx(REST + zero, abs=2e-3)


def test_a_place_may_lie_anywhere_and_a_stiffness_may_not(axis: Path) -> None:
    spring = load_effects(plant=plant_called("axis", "test"))["spring"]
    assert spring.parameters["rest_position"].placed and not spring.parameters["stiffness"].placed
    assert spring.checked({"rest_position": -10.0})["rest_position"] == -10.0
    with pytest.raises(UsageError, match="stiffness"):
        spring.checked({"stiffness": 1e12})
