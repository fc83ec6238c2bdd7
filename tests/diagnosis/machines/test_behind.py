"""A lag behind a dead band is not one before it, and on a linear machine it is that of a late sensor."""

from __future__ import annotations

from pathlib import Path

import pytest
from flywheel import LAG, behind_a_lag

from hjcamp.commands.any_plant.remarks.outside_words import never_alone
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.equivalence import is_of_its_own
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.decision.verdict import decided
from hjcamp.effects import load_effects

BAND = 0.7


@pytest.fixture
def winding(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Measured:
    """Two logs of a motor whose winding lies behind the dead band of its amplifier."""
    monkeypatch.chdir(tmp_path)
    return behind_a_lag(BAND)


def test_what_acts_behind_all_others_is_looked_for_beside_what_bends_its_command(winding: Measured) -> None:
    library = load_effects(plant=winding.plant)
    late = library["action_lag"]
    assert late.behind == "command"
    bends = {name for name, one in library.items() if is_of_its_own(late, [one])}
    assert {"dead_band", "saturation"} <= bends and not bends & {"command_delay", "sensor_gain", "action_lag", "spring"}
    assert all(is_of_its_own(one, []) for name, one in library.items() if name != "action_lag")


def test_what_is_never_looked_for_alone_is_said(winding: Measured) -> None:
    library = load_effects(plant=winding.plant)
    [said] = never_alone({name: library[name] for name in ("command_delay", "action_lag", "spring") if name in library})
    assert said.startswith("action_lag was not tested: ") and "after a nonlinearity of its " in said
    assert never_alone(library) == never_alone({"command_delay": library["command_delay"]}) == []


def test_a_lag_behind_a_dead_band_stands_beside_that_of_the_sensor(winding: Measured) -> None:
    library = load_effects(plant=winding.plant)
    names = ("dead_band", "command_delay", "action_lag", "sensor_lag")
    analysis = calibrated(winding, {name: library[name] for name in names}, unknowns=False)
    found = decided(analysis)
    assert found.word in ("effect", "one_of") and not found.outside
    assert {frozenset(one) for one in found.confidence_set} <= {
        frozenset(("dead_band", "action_lag")),
        frozenset(("dead_band", "sensor_lag")),
    }
    for model in (found.model, *found.rivals):
        effects = model.fitted.candidate.effects
        assert effects["dead_band"]["width"] == pytest.approx(BAND, rel=0.02)
        [late] = [one for name, one in effects.items() if name.endswith("lag")]
        assert late["lag"] == pytest.approx(LAG, rel=0.05)
