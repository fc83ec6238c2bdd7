"""Residuals and block means of one pass are those of the plain formulas, column by column."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.analyses.evidence import evidence_of
from hjcamp.plants.pump_joint.diagnosis.models.saved import complete
from hjcamp.plants.pump_joint.diagnosis.residuals.features import BLOCK, Features
from hjcamp.plants.pump_joint.diagnosis.residuals.passes import (
    LOOK_BACK,
    SURPRISE,
    block_means,
    compile_passes,
    force_errors,
    joint_errors,
    line_errors,
)
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS, Views

Array = Any
PASSES = (joint_errors, line_errors, force_errors, block_means)


def plain_residuals(views: Views, candidate: Candidate) -> Array:
    """The residuals from readings and balance, one formula after the other, each over all samples."""
    evidence = views.evidence
    arm, pressure1, pressure2 = (evidence.joined(name) for name in ("arm", "pressure1", "pressure2"))
    groups = range(len(views.courses.groups))
    joint = views.joint_readings(candidate)
    lines = np.concatenate([views._line_readings(candidate, index) for index in groups])
    balance = np.concatenate([views._balance(candidate, index) for index in groups])
    scale = np.concatenate(
        [np.full(part.stop - part.start, views._sensor_scale(candidate, k)) for k, (part, _) in enumerate(views.courses.groups)]
    )

    def about_mean(error: Array) -> Array:
        length = np.diff(evidence.edges)
        return error - np.repeat(np.add.reduceat(error, evidence.edges[:-1]) / length, length)

    first, second = about_mean(lines[:, 1] - pressure1), about_mean(lines[:, 2] - pressure2)
    push, friction, static, mass = balance.T
    forces = np.zeros((len(arm), 2))
    forces[:, 0] = np.where(evidence.sliding, push - friction - mass * evidence.joined("acceleration"), 0.0)
    events = evidence.breakaways
    before = events[:, None] + np.arange(-LOOK_BACK, 1)
    places = before[np.arange(len(events)), np.argmax(np.abs(push[before]), axis=1)]
    most = SURPRISE * static[places]
    forces[events, 1] = most * np.tanh((np.abs(push[places]) - static[places]) / most)
    home = np.zeros(len(arm))
    known = np.isfinite(evidence.homes)
    home[evidence.edges[:-1]] = np.where(known, views.shown_at_zero(candidate) - evidence.homes, 0.0)
    difference = (joint[:, 1] - pressure1) - (joint[:, 2] - pressure2)
    return np.column_stack([joint[:, 0] - arm, difference, first + second, first - second, forces * scale[:, None], home])


def plain_means(features: Features, residuals: Array) -> Array:
    """The block means from the residuals, with one pass for each sample of a block."""
    total = sum(residuals[features._starts + later] for later in range(BLOCK))
    return np.where(features.valid, total / features._members, 0.0)


@pytest.fixture(
    scope="module",
    params=[
        {},
        pytest.param({"leakage": {}}, marks=pytest.mark.study),
        pytest.param({"pressure_gain": {"error1": 0.2, "error2": 0.2}}, marks=pytest.mark.study),
    ],
)
def seen(leak: Path, request: pytest.FixtureRequest) -> tuple[Views, Candidate]:
    library = load_effects([])
    views = Views(evidence_of([leak]), (library["leakage"], library["pressure_gain"]))
    given = {name: {**library[name].defaults(), **values} for name, values in request.param.items()}
    return views, complete(Candidate({}, given), views.evidence)


def test_one_pass_gives_what_the_formulas_give(seen: tuple[Views, Candidate]) -> None:
    views, candidate = seen
    found, wanted = views.residuals(candidate), plain_residuals(views, candidate)
    for channel, name in enumerate(CHANNELS):
        most = np.abs(wanted[:, channel]).max()
        assert most > 0.0 or name == "home", name
        np.testing.assert_allclose(found[:, channel], wanted[:, channel], rtol=0.0, atol=1e-12 * most, err_msg=name)
    features = Features(views.evidence)
    means = plain_means(features, wanted)
    for channel, name in enumerate(CHANNELS):
        most = np.abs(means[:, channel]).max()
        np.testing.assert_allclose(features.of(found)[:, channel], means[:, channel], rtol=0.0, atol=1e-12 * most, err_msg=name)


def test_without_windows_only_arm_and_difference_are_silent(seen: tuple[Views, Candidate]) -> None:
    views, candidate = seen
    whole, smooth = views.residuals(candidate), views.residuals(candidate, windows=False)
    assert not smooth[:, :2].any()
    assert np.array_equal(smooth[:, 2:], whole[:, 2:])


def test_a_diagnosis_compiles_no_pass_that_was_made_ready(seen: tuple[Views, Candidate]) -> None:
    compile_passes()
    compiled = [len(one.signatures) for one in PASSES]
    views, candidate = seen
    Features(views.evidence).of(views.residuals(candidate))
    views._line_errors(candidate)
    assert [len(one.signatures) for one in PASSES] == compiled == [1, 1, 1, 1]
