"""An input that keeps one value in all tests: nothing can be told of how it acts, and the answers say so."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from gauge import measured_log

from hjcamp.commands.any_plant.words import still_words
from hjcamp.prediction.answer import still_rows
from hjcamp.prediction.measured.tests import measured_tests


def test_an_input_that_never_moves_is_said_so(tanks: Path) -> None:
    moving, logs = measured_log(seed=1), []
    for log in (moving, measured_log(seed=2)):
        logs.append(replace(log, columns=log.columns | {"pump_v": np.full_like(log.columns["pump_v"], 2.5)}))
    assert measured_tests([moving]).still == {} and measured_tests([*logs, moving]).still == {}
    still = measured_tests(logs)
    assert still.still == {"pump_v": 2.5} and still_rows(still) == {"pump_v": {"value": 2.5, "unit": "V"}}
    (said,) = still_words(still_rows(still))
    assert said.startswith("pump keeps one value, 2.5 V, in all tests")
