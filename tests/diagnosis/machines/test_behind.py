"""A lag behind a dead band is not one before it, and on a linear machine it is that of a late sensor."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from flywheel import LAG, behind_a_lag

from hjcamp.commands.any_plant.remarks.outside_words import never_alone
from hjcamp.diagnosis.calibration.analysis import calibrated
from hjcamp.diagnosis.candidates.equivalence import is_of_its_own
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.decision.rivals import ruled_out
from hjcamp.diagnosis.decision.verdict import judged
from hjcamp.diagnosis.selection.forward import Search
from hjcamp.effects import load_effects
from hjcamp.model.declare.candidate import Candidate

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
    found = judged(analysis)
    assert (found.word, set(found.effects)) == ("one_of", {"dead_band", "action_lag", "sensor_lag"})
    assert {frozenset(one) for one in found.confidence_set} == {
        frozenset(("dead_band", "action_lag")),
        frozenset(("dead_band", "sensor_lag")),
    }
    for model in (found.model, *found.rivals):
        effects = model.fitted.candidate.effects
        assert effects["dead_band"]["width"] == pytest.approx(BAND, rel=0.02)
        [late] = [one for name, one in effects.items() if name.endswith("lag")]
        assert late["lag"] == pytest.approx(LAG, rel=0.05)


def test_the_search_goes_on_from_the_lag_beside_which_least_is_left() -> None:
    def scored(left: float, *names: str) -> SimpleNamespace:
        candidate = Candidate({})
        for name in names:
            candidate = candidate.with_effect(name, {})
        return SimpleNamespace(fitted=SimpleNamespace(candidate=candidate), left_out=left, names=names, place=names)

    fits = {name: scored(left, name) for name, left in (("sensor_lag", 3.4), ("command_delay", 4.6), ("action_lag", np.inf))}
    beside = {"sensor_lag": 2.6, "command_delay": 1.3}
    search = Search.__new__(Search)
    search.windows, search.claims = SimpleNamespace(place=None), 0.05  # type: ignore[assignment]
    search.other_lags = lambda name, model: [one for one in fits if one != name]  # type: ignore[method-assign]
    search.in_place = lambda name, other, model: Candidate({}).with_effect(other, {})  # type: ignore[method-assign]
    search.fitted = lambda start, near=None: fits[next(iter(start.effects))]  # type: ignore[method-assign,assignment,return-value]
    search.matters = lambda model, before, level=0.05: True  # type: ignore[method-assign]

    def look(before: SimpleNamespace) -> SimpleNamespace:
        [name] = before.names
        further = scored(beside[name], name, "saturation")
        step = SimpleNamespace(before=before, named=[further], unknown=[], level=0.05, level_of_unknown=0.05, p_value=0.01)
        search.steps.append(step)  # type: ignore[arg-type]
        return step

    search.steps, search.look = [], look  # type: ignore[method-assign,assignment]
    model, step = search.by_another_lag(fits["sensor_lag"], ("sensor_lag",), look(fits["sensor_lag"]))  # type: ignore[arg-type]
    # alone it takes less, and what diverges is not looked at
    assert (model.names, step.before.names, search.windows.place) == (
        ("command_delay",),
        ("command_delay",),
        ("command_delay",),
    )
    assert [one.before.names for one in search.steps] == [("command_delay",)]
    # where nothing is beside it, no other lag is looked at
    calm = look(fits["sensor_lag"])
    calm.p_value = 0.5
    assert search.by_another_lag(fits["sensor_lag"], ("sensor_lag",), calm)[0] is fits["sensor_lag"]  # type: ignore[arg-type]
    assert len(search.steps) == 2


def test_a_rival_that_diverges_is_ruled_out() -> None:
    assert ruled_out(SimpleNamespace(search=None), SimpleNamespace(left_out=np.inf), SimpleNamespace(), SimpleNamespace())  # type: ignore[arg-type]
