"""Where the windows of a fit begin: where it was left, as they did first, or where the last model has led them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from asked import analysed
from carriage import measured_log

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.model.declare.candidate import Candidate


@pytest.fixture
def analysis(axis: Path) -> Analysis:
    measured = measured_tests([measured_log(lambda x, v: -150.0 * (x - 0.03), seconds=4.0)])
    return analysed(measured, ["constant_force", "spring"], unknowns=False)


def test_a_fit_goes_on_where_it_was_left(analysis: Analysis) -> None:
    search = analysis.search
    sprung = analysis.base.fitted.candidate.with_effect("spring", {"stiffness": 150.0, "rest_position": 0.03})
    found = search.settled(sprung)
    assert found.place is not None and not np.array_equal(found.place.starts, search.windows.starts)
    again = search.begun_at(found.candidate, found)
    assert np.array_equal(again.starts, found.place.starts) and again is not search.windows
    # another model is no part of that fit
    other = search.begun_at(sprung, found)
    assert np.array_equal(other.starts, search.windows.starts) and other is not search.windows


def test_what_begins_with_the_base_as_declared_begins_there_as_it_did_first(analysis: Analysis) -> None:
    search = analysis.search
    assert search.first is not None and not np.array_equal(search.first.starts, search.windows.starts)
    declared = Candidate(dict(search.declared), {"spring": {"stiffness": 150.0, "rest_position": 0.03}})
    found = search.begun_at(declared, None)
    assert np.array_equal(found.starts, search.windows.begun_for(declared, search.first).starts)
    before = search.windows.starts.copy()
    search.windows.starts = before + search.windows.sizes
    assert np.array_equal(search.begun_at(declared, None).starts, found.starts)
    assert np.array_equal(search.begun_at(analysis.base.fitted.candidate, None).starts, search.windows.starts)
