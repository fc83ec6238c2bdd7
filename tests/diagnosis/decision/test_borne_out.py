"""A free law that windows show is held against whole short tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from carriage import measured_log

from hjcamp.diagnosis.calibration.analysis import Analysis, calibrated
from hjcamp.diagnosis.data.tests import Measured, measured_tests
from hjcamp.diagnosis.decision.borne_out import names_not_borne_out, not_borne_out, not_in_windows
from hjcamp.effects import load_effects


def short(axis: Path, force: Callable[[float, float], float]) -> Analysis:
    """A short test of a carriage, its controller taken for the input's own."""
    file = axis / "plants" / "axis.py"
    file.write_text(file.read_text().replace('loop = "foreign"', 'loop = ""'))
    measured = measured_tests([measured_log(force, seconds=4.0)])
    library = load_effects(plant=measured.plant)
    return calibrated(measured, {name: library[name] for name in ("spring", "quadratic_drag")})


def test_what_whole_tests_contradict_is_not_borne_out(axis: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sprung = short(axis, lambda x, v: -150.0 * (x - 0.03))
    sprung.search.run(sprung.base)
    first = sprung.search.steps[0]
    [named] = [one for one in first.named if one.names == ("spring",)]
    before = sprung.windows.starts.copy()
    # a drag of the wrong sign is no spring
    wrong = sprung.base.fitted.candidate.with_effect("quadratic_drag", {"drag": -40.0})
    fitted = SimpleNamespace(candidate=wrong)
    name = next(name for name, one in sprung.search.unknowns.items() if (one.quantity, one.driver) == ("force", "velocity"))
    claimed: Any = SimpleNamespace(fitted=fitted, place=sprung.base.place, beyond=lambda base: (name,))
    said = not_borne_out(sprung, first, claimed)
    assert "a force that depends on velocity predicts best" in said and "spring" in said
    assert np.array_equal(sprung.windows.starts, before)
    assert not not_borne_out(sprung, first, named)
    assert "show no effect, but spring takes" in not_in_windows(sprung, first)
    # beside the right law the wrong one is worse by far
    known = replace(sprung, base=named)
    said = names_not_borne_out(known, claimed, ["quadratic_drag"])
    assert said.startswith("in windows of") and "quadratic_drag predicts best, but the error of whole tests" in said
    assert not names_not_borne_out(sprung, named, ["spring"])
    # what repeated tests show in windows they have shown more often
    monkeypatch.setattr(Measured, "repeated", True)
    assert not names_not_borne_out(known, claimed, ["quadratic_drag"])


def test_where_nothing_is_missing_no_effect_takes_most_of_the_error_of_whole_tests(axis: Path) -> None:
    analysis = short(axis, lambda x, v: 0.0)
    analysis.search.run(analysis.base)
    assert not not_in_windows(analysis, analysis.search.steps[0])
