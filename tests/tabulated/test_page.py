"""The answer and the page of a diagnosis: the numbers of a table worked out by hand."""

import json
import math

import numpy as np
import pytest

from hjcamp.plants.pump_joint.tables.answer import answer
from hjcamp.plants.pump_joint.tables.cells import Cells
from hjcamp.plants.pump_joint.tables.diagnosis import Diagnosis, Judged
from hjcamp.plants.pump_joint.tables.fit import Fit
from hjcamp.plants.pump_joint.tables.page import draw, few_told, page
from hjcamp.plants.pump_joint.tables.quantities import quantities_of
from hjcamp.plants.pump_joint.tables.question import Question
from hjcamp.plants.pump_joint.tables.search import Step


def cells(table):
    conditions = [{"trajectory": "ramp_pos", "controller": "pid"}, {"trajectory": "mixed", "controller": "pid"}]
    means, errors = np.array([2.0, 1.0, 4.0, -0.2]), np.array([0.2, 0.1, 0.4, 0.1])
    return Cells((table,) * 4, conditions, np.array([0, 0, 1, 1]), np.array([0, 1, 2, 3]), means, errors, 0.1)


@pytest.fixture
def found():
    names = ("pump_ratio",)
    base = Fit((), {one.name: one.start for one in quantities_of(())}, 30.0)
    better = Fit(names, {one.name: one.start for one in quantities_of(names)} | {"pump_ratio": math.log(0.8)}, 12.0)
    asked, other = (Question((name,), cells(name), (), ()) for name in ("5.4.1", "5.5.1"))
    means = {"published": [4.0, 2.0, 8.0, 0.2], "base": [2.0, 2.0, 8.0, 0.0], "accepted": [2.0, 1.0, 8.0, -0.2]}
    fitted, predicted = (
        {name: Judged(one.cells, np.array(values)) for name, values in means.items()} for one in (asked, other)
    )
    step = Step(base, base, [better], [1.0, 2.0, 0.5])
    models = {"published": Fit((), {}, math.nan), "base": base, "accepted": better}
    return Diagnosis(asked, other, "effect", names, step.p_value, 0.3, (), models, fitted, predicted, [step])


def test_the_answer_holds_the_log_ratios_of_rmse_and_largest_error(found):
    content = answer(found, "quick", 1, "hjcamp diagnose --tables 5.4.1", 1.0)
    json.dumps(content, allow_nan=False)
    ratios = {name: one["mean_abs_log_ratio"]["5.4.1"] for name, one in content["error"].items()}
    two = math.log(2.0)
    assert ratios == pytest.approx({"published": two, "base": 2 * two / 3, "accepted": two / 3})
    # sigma of each share: hypot(0.1, 0.1); of the mean error: hypot(0.1, 0.1) deg
    error = two / math.hypot(0.1, 0.1)
    assert content["error"]["accepted"]["loss"] == pytest.approx(4 * error - 4)
    assert content["error"]["accepted"]["near"] == 3
    assert content["models"]["accepted"]["settings"]["factors"] == pytest.approx(
        {"pump_ratio": 0.8, "pump_bandwidth": 1.0, "pump_latency": 1.0}
    )
    assert content["models"]["accepted"]["quantities"]["pump_ratio"]["sigma_from_published"] == pytest.approx(
        math.log(0.8) / 0.35
    )


def test_the_page_shows_verdict_errors_and_every_cell(found, tmp_path):
    told = page(answer(found, "quick", 1, "hjcamp diagnose --tables 5.4.1", 1.0))
    assert "**The table is met with pump_ratio.**" in told
    assert "| accepted | 5.5.1 | held out | 0.23 |" in told
    assert told.count("| ramp_pos pid | rmse1_deg | 2 |") == 2
    assert "| `pump_ratio` | 1 | 1 |" in told
    draw(answer(found, "quick", 1, "", 1.0), tmp_path / "cells.png")
    assert (tmp_path / "cells.png").read_bytes().startswith(b"\x89PNG")


def test_a_table_of_mean_errors_alone_has_no_ratio_to_draw(found, tmp_path):
    content = answer(found, "quick", 1, "hjcamp diagnose --tables 5.4.1", 1.0)
    mean_errors = [row for row in content["cells_held_out"] if row["indicator"] == "sse_deg"]
    picture = tmp_path / "cells.png"
    draw(content | {"cells_held_out": mean_errors}, picture)
    assert picture.exists()
    picture.unlink()
    content |= {"cells": mean_errors, "cells_held_out": mean_errors}
    draw(content, picture)
    assert not picture.exists() and "cells.png" not in page(content)


def test_as_few_means_as_fitted_quantities_are_no_proof(found):
    content = answer(found, "quick", 1, "hjcamp diagnose --tables mine.csv", 1.0)
    fitted = len(content["models"]["accepted"]["quantities"])
    assert f"4 means against {fitted} fitted quantities" in page(content)
    more = content | {"cells": content["cells"] * fitted}
    assert few_told(more) == "" and "fitted quantities" not in page(more)
