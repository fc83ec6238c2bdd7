"""What the explorer gets of any plant: whole tests as they were logged, and predictions where windows were looked at."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from hjcamp.commands.any_plant.explorer import modelled_tests
from hjcamp.diagnosis.data.measured_test import MeasuredTest
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.data.tests import Measured, Sensor
from hjcamp.known_plants import find_plant
from hjcamp.records.log import TestLog

WIDTH = 16


LEAD = 2


def made(name: str, samples: int) -> MeasuredTest:
    time = np.arange(samples) * 0.002
    position = 0.01 * time
    columns = {"time_s": time, "position_mm": 1e3 * position, "voltage_v": np.cos(time), "remark": time}
    log = TestLog(columns, {"condition": "sweep", "repetition": name})
    given = np.zeros((samples, 1))
    return MeasuredTest(name, "sweep", time[LEAD:], given[LEAD:], position[LEAD:, None], (), log, given[:LEAD])


def test_predictions_stand_where_their_windows_do_in_the_units_of_the_log() -> None:
    tests = (made("1", LEAD + 5 * WIDTH + 3), made("2", LEAD + 2 * WIDTH))
    layout = Layout(Measured(find_plant("valve_joint"), 0.002, (Sensor("position_mm", "mm", 1e3),), (0,), tests), WIDTH, 0.5)
    rows = len(layout.of_test) * WIDTH
    assert layout.counts == [3, 1]
    errors = np.repeat(np.arange(4.0), WIDTH)[:, None] * 1e-6
    models: Any = (SimpleNamespace(name="one", errors=errors),)
    assert len(errors) == rows
    analysis = SimpleNamespace(windows=SimpleNamespace(layout=layout))
    found: Any = SimpleNamespace(
        analysis=analysis, models=models, calibrated=SimpleNamespace(name="two", errors=errors), lesser=()
    )
    first, second = modelled_tests(found)
    assert (first.name, second.name) == ("sweep/1", "sweep/2")
    # a column without a unit is no channel
    assert sorted(first.measured) == ["position_mm", "voltage_v"] and sorted(first.models) == ["one", "two"]
    predicted = first.models["one"]["position_mm"]
    expected = np.full(LEAD + 5 * WIDTH + 3, np.nan)
    for window, place in enumerate((0, 2, 3)):
        part = slice(LEAD + place * WIDTH, LEAD + (place + 1) * WIDTH)
        expected[part] = first.measured["position_mm"][part] - 1e-3 * window
    np.testing.assert_allclose(predicted, expected)
    part = slice(LEAD, LEAD + WIDTH)
    np.testing.assert_allclose(second.models["two"]["position_mm"][part], second.measured["position_mm"][part] - 3e-3)
    assert np.isnan(second.models["two"]["position_mm"][part.stop :]).all()
