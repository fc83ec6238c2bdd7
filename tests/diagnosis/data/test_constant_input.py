"""An input that keeps one value in all tests: nothing can be told of how it acts, and the answers say so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from gauge import measured_log

from hjcamp.commands.any_plant.words import still_words
from hjcamp.diagnosis.calibration import sufficiency
from hjcamp.diagnosis.calibration.sufficiency import what_lacks
from hjcamp.diagnosis.data.tests import measured_tests
from hjcamp.diagnosis.results.channel_rows import still_rows


def test_an_input_that_never_moves_is_said_so(tanks: Path) -> None:
    moving, logs = measured_log(seed=3), []
    for log in (measured_log(seed=1), measured_log(seed=2)):
        logs.append(replace(log, columns=log.columns | {"pump_v": np.full_like(log.columns["pump_v"], 2.5)}))
    assert measured_tests([moving]).still == {} and measured_tests([*logs, moving]).still == {}
    # a log with the readings of another is a copy of it, and what its inputs did does not count
    assert measured_tests([*logs, measured_log(seed=1)]).still == {"pump_v": 2.5}
    still = measured_tests(logs)
    assert still.still == {"pump_v": 2.5} and still_rows(still) == {"pump_v": {"value": 2.5, "unit": "V"}}
    (said,) = still_words(still_rows(still))
    assert said.startswith("pump keeps one value, 2.5 V, in all tests")


def test_what_moves_before_what_is_looked_at_is_not_still(tanks: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = measured_log(seed=1)
    begun = np.full_like(log.columns["pump_v"], 2.5)
    begun[0] = 0.0
    measured = measured_tests([replace(log, columns=log.columns | {"pump_v": begun})])
    [test] = measured.tests
    assert len(test.earlier) and np.ptp(test.inputs[:, 0]) == 0.0 and measured.still == {}
    monkeypatch.setattr(sufficiency, "blocks_of", lambda layout: np.arange(2))
    monkeypatch.setattr(sufficiency, "moves", lambda layout: np.ones(3, dtype=bool))
    [lead] = what_lacks(measured, SimpleNamespace(of_test=np.zeros(3), width=16))  # type: ignore[arg-type]
    assert f"these have {test.samples} behind {len(test.earlier)} that tell what inputs were before)" in lead
