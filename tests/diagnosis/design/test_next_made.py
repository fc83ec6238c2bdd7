"""Proposed tests as a hunt makes them: a motion that the campaign's loop follows from its start and back, within every limit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from test_next_rivals import NOTHING_SAID, analysis_of

from hjcamp.analyses import proposing
from hjcamp.analyses.diagnosing import PlantDiagnosed
from hjcamp.analyses.proposing import PlantProposed
from hjcamp.backends import plant_simulation
from hjcamp.commands.hunting.any_plant import Makeable, choose, from_start_and_back
from hjcamp.commands.hunting.chosen import condition_name
from hjcamp.configuration.composer import Composer, free
from hjcamp.diagnosis.design import proposal
from hjcamp.diagnosis.design.proposal import propose
from hjcamp.diagnosis.design.rivals import question_of
from hjcamp.diagnosis.design.wanted import Wanted
from hjcamp.known_plants import find_plant

LOOP = ("controller=plain_pid", "controller.kp=20000", "controller.kd=300", "trajectory=sine", "trajectory.amplitude_m=0.05")


@pytest.fixture
def done(axis: Path, monkeypatch: pytest.MonkeyPatch) -> PlantDiagnosed:
    """Return a diagnosis whose question is drag or nothing, without the search before it."""
    analysis = analysis_of(600.0)

    def after(done: Any, rivals: Any, tests: int, seed: int, report: Any, makeable: Any) -> PlantProposed:
        question = question_of(analysis, NOTHING_SAID, [], ["quadratic_drag"])
        return PlantProposed(analysis, NOTHING_SAID, propose(analysis, question, tests, report, makeable), None)

    monkeypatch.setattr(proposing, "propose_after", after)
    return PlantDiagnosed(analysis, None, dict(NOTHING_SAID))  # type: ignore[arg-type]


def config_of(done: PlantDiagnosed, *lines: str) -> dict[str, Any]:
    words = [f"plant={done.analysis.measured.plant.name}", *LOOP, *lines]
    return dict(Composer().compose([free(line) for line in words]).config)


def silent(text: str, share: float) -> None:
    """Report nothing."""


def test_the_loop_of_the_campaign_makes_the_proposed_motion(done: PlantDiagnosed) -> None:
    found = choose(done, 1, [config_of(done)], 2, 3, silent)
    assert found.configs and all(name.startswith("t3_") for name in found.configs) and found.answer["tests"]
    for config in found.configs.values():
        columns, _ = plant_simulation.run_test(config, 1)
        wanted, got = columns["reference_position_m"], columns["position_m"]
        assert wanted[0] == 0.0 and abs(wanted[-1]) < 1e-6 and np.ptp(wanted) > 0.01
        assert np.sqrt(np.mean((wanted - got) ** 2)) < 0.02 * np.ptp(wanted)


def test_what_passes_a_limit_is_not_chosen(done: PlantDiagnosed, monkeypatch: pytest.MonkeyPatch) -> None:
    [before, *_] = choose(done, 1, [config_of(done)], 1, 1, silent).configs.values()
    fastest = np.abs(plant_simulation.run_test(before, 1)[0]["voltage_v"]).max()
    inputs: Any = find_plant("axis").inputs
    whole = proposal.menu
    monkeypatch.setattr(proposal, "menu", lambda *given: whole(*given)[:4])  # a few are enough to run out of
    for limit, any_left in ((1.01 * fastest, True), (0.01 * fastest, False)):
        with monkeypatch.context() as narrowed:
            narrowed.setitem(inputs, "voltage", replace(inputs["voltage"], plausible=(-limit, limit)))
            found = choose(done, 1, [config_of(done)], 1, 1, silent)
        assert bool(found.configs) == any_left
        for config in found.configs.values():
            assert np.abs(plant_simulation.run_test(config, 1)[0]["voltage_v"]).max() <= limit
    assert "no test within the limits" in found.why and "voltage_v would leave" in found.why


def test_a_campaign_without_a_loop_makes_no_motion(done: PlantDiagnosed) -> None:
    config = dict(
        Composer().compose([f"plant={done.analysis.measured.plant.name}", "controller=given", "trajectory=hold"]).config
    )
    found = choose(done, 1, [config], 1, 1, silent)
    assert not found.configs and "no controller of the campaign follows one (controller=plain_pid does)" in found.why


def test_what_needs_hands_or_another_start_is_not_made(done: PlantDiagnosed) -> None:
    measured = done.analysis.measured
    count = len([name for name in measured.plant.inputs if name not in ("time", "direction")])
    inputs = np.tile(
        [measured.plant.inputs[name].default for name in measured.plant.inputs if name not in ("time", "direction")], (9, 1)
    )
    one = Wanted("push", "push", 0, inputs, np.zeros((9, 1)), measured.tests[0].given, pieces=((1.0, 0.5),), driven="voltage")
    assert inputs.shape == (9, count)
    simulated, rig = config_of(done), config_of(done, "backend=rig", "rig=simulated")
    for wanted, by_motion, here, there in (
        (one, False, True, True),
        (one, True, True, True),
        (replace(one, given=(("mass", 1.0),)), True, False, False),
        (replace(one, pieces=()), False, False, False),
        (replace(one, start_at=5), False, True, False),
        (replace(one, begun=0.5), False, True, False),
        (replace(one, driven="another", inputs=inputs + 1.0), False, False, False),
    ):
        assert (Makeable(done, [simulated])(wanted, by_motion), Makeable(done, [rig])(wanted, by_motion)) == (here, there)


@pytest.mark.parametrize("start", [0.0, 0.03, -0.2])
@pytest.mark.parametrize("end", [0.0, 0.1])
def test_the_ways_there_and_back_are_no_faster_than_the_path(start: float, end: float) -> None:
    time = np.arange(2000) * 1e-3
    path: NDArray[np.float64] = start + (end - start) * (time / time[-1]) ** 2 + 0.02 * np.sin(2 * np.pi * time)
    whole = from_start_and_back(path, 1e-3)
    assert abs(whole[0]) < 1e-3 and abs(whole[-1]) < 1e-3
    assert np.abs(np.diff(whole)).max() <= 1.01 * np.abs(np.diff(path)).max() + abs(path[0]) * 1e-3
    at = len(whole) - len(path)
    assert any(np.array_equal(whole[k : k + len(path)], path) for k in range(at + 1))


def test_names_of_conditions_are_safe_and_their_own() -> None:
    taken: list[str] = []
    for text in ("a/b", "a b", "t1_a-b", "../..", "", "t2_t1_a-b"):
        taken.append(condition_name(text, 2, taken))
    assert taken[:3] == ["t2_a-b", "t2_a-b-2", "t2_a-b-3"] and len(set(taken)) == len(taken)
    assert all(not set(name) & set("/ ") and not name.startswith(".") for name in taken)
