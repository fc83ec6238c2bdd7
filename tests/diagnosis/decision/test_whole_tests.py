"""A model that errs by more over whole tests than the base does is contradicted by them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.decision.whole_tests import contradicted
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.candidate import Candidate


def with_loss(analysis: Analysis, factor: float) -> Scored:
    """Return the base with so many times its loss."""
    fitted = analysis.base.fitted
    candidate = Candidate({"loss": factor * fitted.candidate.base["loss"]}, {})
    return replace(analysis.base, fitted=replace(fitted, candidate=candidate))


@pytest.mark.parametrize(
    ("base", "model", "against"), [(1.0, 1.3, True), (1.0, 1.0, False), (1.3, 1.0, False), (1.3, 1.9, True)]
)
def test_it_is_where_whole_tests_are_explained_less_by_delta(slab: Measured, base: float, model: float, against: bool) -> None:
    analysis = calibrated(slab, {}, unknowns=False)
    found = contradicted(replace(analysis, base=with_loss(analysis, base)), with_loss(analysis, model), 0.1)
    assert bool(found) == against, found
    # channel, both errors and their unit
    assert not against or (" -> " in found and found.endswith(")"))


def test_where_nothing_is_simulated_whole_nothing_is_contradicted(slab: Measured) -> None:
    analysis = calibrated(slab, {}, unknowns=False)
    find_plant("slab").loop = "foreign"
    assert contradicted(analysis, with_loss(analysis, 1.9), 0.1) == ""
