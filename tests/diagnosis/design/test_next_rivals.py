"""Rivals whose best test is known by hand, on a carriage that shares no code with the program."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from answer_schemas import check_answer
from carriage import COULOMB, GAIN, MASS, PERIOD, VISCOUS, measured_log
from numpy.typing import NDArray

from hjcamp.analyses.proposing import PlantProposed
from hjcamp.commands.any_plant.next_answer import answer
from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.design.proposal import APART, Proposal, propose
from hjcamp.diagnosis.design.rivals import Question, question_of
from hjcamp.diagnosis.design.truth import bench_of, held_by_loop
from hjcamp.diagnosis.design.wanted import Wanted
from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.notebook.proposal import Proposal as Proposed
from hjcamp.records.log import TestLog

LIBRARY = ("constant_force", "quadratic_drag", "spring")
SPEED, REACH = 0.12, 0.06
NOTHING_SAID = {"verdict": None, "effects": [], "candidates": [], "confidence_set": [], "unknowns": []}


def to_and_fro(time: NDArray[np.float64]) -> NDArray[np.float64]:
    """One speed in both directions."""
    return REACH - np.abs(np.mod(SPEED * time + REACH, 4.0 * REACH) - 2.0 * REACH)


@cache
def log(drag: float) -> TestLog:
    return measured_log(lambda x, v: -drag * v * abs(v), seconds=8.0, path=to_and_fro if drag else None)


@cache
def analysis_of(drag: float) -> Analysis:
    measured = measured_tests([log(drag)])
    library = load_effects(plant=measured.plant)
    return calibrated(measured, {name: library[name] for name in LIBRARY})


def proposed(analysis: Analysis, *names: str) -> Proposal:
    return propose(analysis, question_of(analysis, NOTHING_SAID, [], names))


def test_drag_and_viscous_friction_are_told_by_speed(axis: Path) -> None:
    analysis = analysis_of(600.0)
    found = proposed(analysis, "quadratic_drag")
    assert found.by_motion and found.chosen >= 1
    [apart] = found.tests[0].pairs.values()
    assert apart >= APART
    # at one speed a viscous friction does what the drag does: the best test goes at another one
    changed = [one.wanted.changes.get("speed", 1.0) for one in found.tests[: found.chosen]]
    assert all(speed != 1.0 and abs(speed / SPEED - 1.0) > 0.2 for speed in changed)
    assert all(each.share <= 0.5 for one in found.tests for each in one.beyond)
    # the same in Python: a row for each test and pair, and a picture
    done = PlantProposed(analysis, NOTHING_SAID, found, None)
    shown = Proposed(done, answer(done, None, None, 0.0))
    check_answer(shown.answer)
    assert shown.title.startswith("PROPOSED") and shown.frame["rivals"].unique().to_list() == ["quadratic_drag / nothing"]
    assert shown.frame["worth_it"].sum() == found.chosen and len(shown.plot().axes) >= 3


def test_where_nothing_tells_no_test_is_proposed(axis: Path) -> None:
    # two explanations that say the same of every test
    analysis = analysis_of(0.0)
    [one, _] = question_of(analysis, NOTHING_SAID, [], ["nothing", "quadratic_drag"]).rivals
    other = replace(one, names=("another_name",), draws=one.draws[::-1])
    found = propose(analysis, Question((one, other), ((0, 1), (1, 0))))
    assert found.chosen == 0 and found.together == {} and found.tried > 5
    # one that tells them apart is worth several
    assert found.best < 0.5
    # nothing in its equations brings the carriage back to where it was
    assert held_by_loop(analysis)


def test_a_course_is_simulated_whole_and_ends_at_the_speed_of_the_balance_of_forces(axis: Path) -> None:
    analysis = analysis_of(0.0)
    volts, samples = 2.0, 2000
    names = [name for name in analysis.measured.plant.inputs if name not in ("time", "direction")]
    inputs = np.ones((samples, len(names)))
    inputs[:, names.index("voltage")] = volts
    one = Wanted("push", "push", 0, inputs, np.zeros((samples, 1)))
    truth = Candidate({"mass": MASS, "coulomb": COULOMB, "viscous": VISCOUS})
    found = bench_of(analysis, [one], truth, by_motion=False).simulated(analysis, truth)
    speed = np.diff(found.layout.readings[:, 0])[-5:] / PERIOD
    assert speed == pytest.approx((GAIN * volts - COULOMB) / VISCOUS, rel=1e-3)
    assert np.all(np.diff(found.starts[:, 0]) > 0.0)
    # what a model would predict from these starts is what was simulated
    assert np.abs(found.errors(truth)).max() < 1e-9
