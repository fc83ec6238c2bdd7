"""A free law that windows show is held against whole short tests."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from carriage import measured_log

from hjcamp.effects import load_effects
from hjcamp.prediction.analysis import Analysis, calibrated
from hjcamp.prediction.borne_out import not_borne_out
from hjcamp.prediction.measured import measured_tests


@pytest.fixture
def sprung(axis: Path) -> Analysis:
    """A short test of a carriage on a hidden spring, its controller taken for the input's own."""
    file = axis / "plants" / "axis.py"
    file.write_text(file.read_text().replace('loop = "foreign"', 'loop = ""'))
    measured = measured_tests([measured_log(lambda x, v: -150.0 * (x - 0.03), seconds=4.0)])
    library = load_effects(plant=measured.plant)
    return calibrated(measured, {name: library[name] for name in ("spring", "quadratic_drag")})


def test_what_whole_tests_contradict_is_not_borne_out(sprung: Analysis) -> None:
    sprung.search.run(sprung.base)
    first = sprung.search.steps[0]
    [named] = [one for one in first.named if one.names == ("spring",)]
    before = sprung.windows.starts.copy()
    # a drag of the wrong sign is no spring
    wrong = sprung.base.fitted.candidate.with_effect("quadratic_drag", {"drag": -40.0})
    fitted = SimpleNamespace(candidate=wrong)
    claimed: Any = SimpleNamespace(fitted=fitted, place=sprung.base.place, beyond=lambda base: ("unknown_drag",))
    said = not_borne_out(sprung, first, claimed)
    assert "unknown drag predicts best" in said and "spring" in said
    assert np.array_equal(sprung.windows.starts, before)
    assert not not_borne_out(sprung, first, named)
