"""Cells are judged by the error of form that a model leaves, where that is less than what is allowed."""

import numpy as np
import pytest

from hjcamp.plants.pump_joint.tables.cells import LEAST_FORM, Cells, robust

COUNT = 40


@pytest.fixture
def cells():
    conditions = [{"trajectory": str(number)} for number in range(COUNT)]
    means = np.linspace(1.0, 4.0, COUNT)
    return Cells(("t",) * COUNT, conditions, np.arange(COUNT), np.zeros(COUNT, dtype=int), means, 0.001 * means, 0.0)


def off_by(cells, share):
    return cells.means * np.exp(share * np.where(np.arange(COUNT) % 2, 1.0, -1.0))


def test_an_even_error_of_three_percent_is_the_form_that_is_left(cells):
    known = cells.known_by(off_by(cells, 0.03), 10)
    # 40 errors of one size, 30 cells free: each is 0.866 sigma; sigma^2 = 0.001^2 + (0.1 form)^2
    assert 0.1 * known.form == pytest.approx(np.sqrt(0.03**2 * 40 / 30 - 0.001**2), rel=1e-3)
    assert robust(known.errors(off_by(cells, 0.03))).sum() == pytest.approx(30.0, rel=1e-3)


def test_no_more_form_is_allowed_than_ten_percent_and_none_is_not_quite_zero(cells):
    assert cells.known_by(off_by(cells, 0.3), 10) is cells
    assert cells.known_by(cells.means, 10).form == LEAST_FORM


def test_twins_are_drawn_by_the_form_that_is_left(cells):
    known = cells.known_by(off_by(cells, 0.03), 10)
    moved = [np.log(known.drawn(cells.means, np.random.default_rng(seed)).means / cells.means) for seed in range(200)]
    assert np.std(moved) == pytest.approx(np.hypot(0.001, 0.1 * known.form), rel=0.05)
