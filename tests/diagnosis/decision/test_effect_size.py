"""How large an effect is at the tests' own operating point, whatever its law."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from asked import analysed
from carriage import MASS, PERIOD, measured_log

from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.decision.effect_size import functional, in_proportion
from hjcamp.effects import load_effects
from hjcamp.known_plants import find_plant


def test_a_force_bends_a_window_by_what_newton_says(axis: Path) -> None:
    names = ["constant_force", "spring"]
    analysis = analysed(measured_tests([measured_log(lambda x, v: 6.0, seconds=8.0)]), names, unknowns=False)
    base = analysis.base.fitted.candidate
    forced = base.with_effect("constant_force", {"strength": 2.0})
    model = analysis.search.scored(analysis.search.fitted(forced).fitted)
    fitted = model.fitted.candidate.effects["constant_force"]["strength"]
    assert abs(fitted) == pytest.approx(6.0, rel=0.2)
    found = functional(analysis, "constant_force", model, {"strength": {"value": fitted, "ci95": [0.5 * fitted, 1.5 * fitted]}})
    # y = F t^2 / (2 m) less the best straight line has the rms T^2 / sqrt(180) of its factor; where it rests it moves nothing
    span = analysis.windows.layout.width * PERIOD
    expected = abs(fitted) / (2.0 * MASS) * span**2 / math.sqrt(180.0)
    assert found["unit"] == "m" or found["unit"] == "mm"
    value = found["value"] * (1e-3 if found["unit"] == "mm" else 1.0)
    assert 0.6 * expected < value < 1.1 * expected and found["name"] == "change of position"
    assert np.allclose(found["ci95"], [0.5 * found["value"], 1.5 * found["value"]])


def test_an_interval_is_in_proportion_to_the_amplitude(axis: Path) -> None:
    library = load_effects(plant=find_plant("axis"))
    gain = library["sensor_gain"]
    name = next(one for one, item in gain.parameters.items() if item.off is not None)
    off = gain.parameters[name].off or 0.0
    assert in_proportion(gain, {name: {"value": off - 0.2, "ci95": [off - 0.3, off - 0.1]}}, 4.0) == pytest.approx([2.0, 6.0])
    assert in_proportion(gain, {name: {"value": off + 0.2, "ci95": [off - 0.1, off + 0.3]}}, 4.0) == pytest.approx([0.0, 6.0])
    assert in_proportion(gain, {name: {"value": off, "ci95": [off, off]}}, 0.0) is None
    assert in_proportion(gain, {}, 1.0) is None and in_proportion(gain, {name: {"value": 1.3, "ci95": None}}, 1.0) is None
    # a limit is absent at its far end: no size is in proportion to the distance from there
    assert in_proportion(library["saturation"], {"limit": {"value": 3.0, "ci95": [2.0, 4.0]}}, 1.0) is None
