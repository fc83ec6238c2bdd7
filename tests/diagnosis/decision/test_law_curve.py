"""The law of a named effect over the driver of an unknown, against what its formula gives."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hjcamp.commands.any_plant.law_words import described_term
from hjcamp.commands.any_plant.remarks.outside_words import over_time_words
from hjcamp.diagnosis.candidates.nonparametric_terms import unknowns_of
from hjcamp.diagnosis.decision.law_curve import law_curves
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.candidate import Candidate

STIFFNESS, REST = 140.0, 0.02
SAMPLES, WIDTH = 400, 40
TIME = np.arange(SAMPLES) * 2e-3
STATES = np.column_stack([0.1 * np.sin(8.0 * TIME), 0.8 * np.cos(8.0 * TIME)])


def curves(name: str, values: dict[str, float], unknown: str, beside: dict[str, float] | None = None) -> list[Any]:
    """Return the curves of an effect on the template's carriage, swinging through 0.1 m, beside a base that is as declared."""
    plant = find_plant("axis")
    library = load_effects(plant=plant)
    ranges = {
        "position": (-0.1, 0.1),
        "velocity": (-0.8, 0.8),
        "friction_speed": (0.0, 0.8),
        "load": (-10.0, 10.0),
        "friction": (-20.0, 20.0),
    }
    known = unknowns_of(plant, ranges)[unknown]
    candidate = Candidate({"mass": 80.0, "delay.voltage": 0.002}, {name: {**library[name].defaults(), **values}})
    given = [item.default for key, item in plant.inputs.items() if key not in ("time", "direction")]
    layout = SimpleNamespace(
        width=WIDTH,
        inputs=np.tile(given, (SAMPLES, 1)),
        time=TIME,
        groups=[({}, np.ones(SAMPLES // WIDTH, dtype=bool))],
    )
    windows = SimpleNamespace(layout=layout, readings=lambda candidate: (None, STATES))
    analysis: Any = SimpleNamespace(
        windows=windows, measured=SimpleNamespace(plant=plant), search=SimpleNamespace(library=library), base=None
    )
    model: Any = SimpleNamespace(fitted=SimpleNamespace(candidate=candidate), beyond=lambda base: (name,))
    return law_curves(analysis, model, known, Candidate(dict(beside or candidate.base), {}))


def test_a_spring_is_the_force_that_it_is_both_ways(axis: Path) -> None:
    found = curves("spring", {"stiffness": STIFFNESS, "rest_position": REST}, "unknown_force_over_position")
    assert sorted(one.sign for one in found) == [-1.0, 1.0]
    for one in found:
        seen = np.isfinite(one.y)
        assert seen.sum() > 10
        # a bin holds places up to half its width away
        assert np.allclose(one.y[seen], -STIFFNESS * (one.x[seen] - REST), atol=STIFFNESS * 0.5 * 0.2 / 14)


def test_what_the_base_had_taken_for_it_is_part_of_what_was_missing(axis: Path) -> None:
    # beside the unknown the base had 2 N more of Coulomb friction
    coulomb = find_plant("axis").parameters["coulomb"].default
    base = {"mass": 80.0, "coulomb": coulomb + 2.0, "delay.voltage": 0.002}
    law = {"stiffness": STIFFNESS, "rest_position": REST}
    found = curves("spring", law, "unknown_force_over_position", base)
    for one in found:
        seen = np.isfinite(one.y)
        wanted = 2.0 * one.sign - STIFFNESS * (one.x[seen] - REST)
        assert np.allclose(one.y[seen], wanted, atol=STIFFNESS * 0.5 * 0.2 / 14)


def test_friction_by_direction_is_a_force_of_either_sign(axis: Path) -> None:
    found = curves("coulomb_asymmetry", {"asymmetry": 0.25}, "unknown_force_over_position")
    # 20 N of Coulomb friction: 5 N more forwards, 5 N less backwards, both a force against the positive direction
    for one in found:
        assert np.nanmax(np.abs(one.y + 5.0)) < 1e-6


def test_what_has_a_memory_or_acts_elsewhere_has_no_curve(axis: Path) -> None:
    assert curves("static_friction_ageing", {}, "unknown_force_over_position") == []
    assert curves("sensor_gain", {}, "unknown_force_over_position") == []


def test_drag_over_speed_is_as_much_friction(axis: Path) -> None:
    found = curves("quadratic_drag", {}, "unknown_friction_over_speed")
    [drag] = [item.default for item in load_effects(plant="axis")["quadratic_drag"].parameters.values()][:1]
    for one in found:
        seen = np.isfinite(one.y)
        assert one.y[seen] == pytest.approx(drag * one.x[seen] ** 2, abs=drag * 0.8 * 2 * 0.8 / 28 + 1e-9)


def test_what_leaks_between_stores_is_said_of_both() -> None:
    row = {"quantity": "loss", "port": "a_and_b", "driver": "a_and_b_difference", "signal": "pressure_a - pressure_b"}
    assert described_term(row) == "leak from pressure a to pressure b that depends on their difference"
    row = {"quantity": "force", "port": "velocity", "driver": "velocity_position", "signal": "position", "apart_s": 0.0}
    assert described_term(row) == "force at velocity that depends on its position"
    assert described_term({**row, "driver": "time", "signal": "time"}) == "force at velocity that changes with time"


@pytest.mark.parametrize(
    ("driver", "repeated", "said"), [("time", False, 1), ("time", True, 0), ("velocity_position", False, 0)]
)
def test_what_changes_with_time_in_one_test_may_be_remembered(driver: str, repeated: bool, said: int) -> None:
    found = over_time_words({"driver": driver, "apart_s": 0.0}, repeated)
    assert len(found) == said and all("an unmodelled memory" in one for one in found)
