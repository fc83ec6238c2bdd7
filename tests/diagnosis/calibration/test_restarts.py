"""A base in a poor minimum is begun anew from where a fit beside it has led it, and one that a wrong unit pushes to a bound is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from slab import PLANT

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.calibration.restarts import better_base
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.estimation.intervals import intervals
from hjcamp.diagnosis.estimation.likelihood import loss
from hjcamp.known_plants import find_plant
from hjcamp.model.declare.candidate import Candidate


def at(analysis: Analysis, value: float) -> Analysis:
    """Return an analysis whose base has stayed at a loss of ``value``, W/K."""
    windows = replace(analysis.windows)
    candidate = Candidate({**analysis.base.fitted.candidate.base, "loss": value}, {})
    windows.move_starts(candidate)
    features = windows.features(candidate)
    fitted = replace(analysis.base.fitted, candidate=candidate, features=features, loss=loss(features))
    return replace(analysis, windows=windows, base=replace(analysis.base, fitted=fitted, place=windows.place))


def test_a_base_in_a_poor_place_is_begun_from_where_a_fit_beside_it_has_led_it(slab: Measured) -> None:
    analysis = calibrated(slab, {}, unknowns=False)
    beside = replace(analysis.base, names=("something",))
    found = better_base(at(analysis, 20.0), at(analysis, 20.0).base, [beside])
    assert found is not None and found["loss"] == pytest.approx(2.5, rel=0.02)
    # nothing is better than what fits, and of what is not said only what is elsewhere is tried
    assert better_base(analysis, replace(at(analysis, 20.0).base, names=("something",)), []) is None
    assert better_base(at(analysis, 3.0), at(analysis, 3.0).base, [beside]) is None
    said = better_base(at(analysis, 3.0), beside, [])
    assert said is not None and said["loss"] == pytest.approx(2.5, rel=0.02)


@pytest.mark.parametrize(
    ("declared", "bounds", "held"),
    [
        (0.2, (0.01, 0.6), ("loss",)),  # 2.5 is right
        (0.6, (0.01, 0.6), ()),  # the bound is what was declared
        (2.0, (0.01, 100.0), ()),
    ],
)
def test_a_parameter_that_would_go_on_beyond_its_bound_is_held(
    slab: Measured,
    declared: float,
    bounds: tuple[float, float],
    held: tuple[str, ...],
) -> None:
    plant = find_plant("slab")
    plant.parameters["loss"] = replace(plant.parameters["loss"], default=declared, bounds=bounds)
    analysis = calibrated(slab, {}, unknowns=False)
    assert analysis.base.fitted.candidate.base["loss"] == pytest.approx(min(2.5, bounds[1]), rel=0.02)
    assert analysis.held == held


def test_two_gains_of_which_the_product_alone_is_told_are_held_where_it_would_go_on(
    slab: Measured,
    tmp_path: Path,
) -> None:
    both = '    gain = Parameter("1", 0.5, (0.1, 0.6), base=True)\n    scale = Parameter("1", 0.5, (0.1, 0.6), base=True)\n    period'
    text = PLANT.replace("    period", both).replace("drive.power -", "parameter.gain * parameter.scale * drive.power -")
    (tmp_path / "plants" / "slab.py").write_text(text.replace("(0.01, 100.0)", "(2.0, 3.0)"))
    plant = find_plant("slab")
    analysis = calibrated(replace(slab, plant=plant), {}, unknowns=False)
    rows = {one.name: one for one in intervals(analysis.base.fitted, analysis.search.blocks)}
    assert not rows["gain"].told and rows["gain"].at_bound
    assert set(analysis.held) >= {"gain", "scale"}
