"""A user's effects have a small kernel of their own beside that of the library, and a diagnosis considers what is named."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from hjcamp.analyses.diagnosing import considered
from hjcamp.effects import load_effects
from hjcamp.effects._template import template
from hjcamp.errors import UsageError
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.residuals import kernel_choice
from hjcamp.plants.pump_joint.diagnosis.residuals.kernel_choice import chosen_for, first_needed
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.studies import warm

LIBRARY = tuple(load_effects([]).values())


@pytest.fixture
def everything(tmp_path: Path) -> dict:
    """The library with an effect of the user's."""
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "mine.py").write_text(template("mine", PumpJoint))
    return load_effects([tmp_path / "effects"])


def names(effects: tuple) -> set[str]:
    return {effect.name for effect in effects}


def test_a_new_effect_leaves_the_kernel_of_the_library_as_it_is(everything: dict) -> None:
    chosen = tuple(everything.values())
    assert chosen_for(chosen, {"leakage"}) == LIBRARY
    assert names(chosen_for(chosen, {"mine"})) == {"mine", "gravity_load"}
    assert names(chosen_for(chosen, {"mine", "gravity_load"})) == {"mine", "gravity_load"}
    assert chosen_for(chosen, {"mine", "leakage"}) == chosen
    assert chosen_for(chosen, set()) == ()
    assert [names(effects) for effects in first_needed(chosen)] == [set(), names(LIBRARY), {"mine", "gravity_load"}]
    assert [names(effects) for effects in first_needed(LIBRARY)] == [set(), names(LIBRARY)]


@pytest.mark.parametrize("compiled", [True, False])
def test_few_effects_of_the_library_take_its_kernel_where_that_is_there(
    everything: dict, compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kernel_choice, "_library_is_compiled", lambda: compiled)
    chosen = (everything["leakage"], everything["mine"])
    assert chosen_for(chosen, {"leakage"}) == (LIBRARY if compiled else chosen)
    assert chosen_for(chosen, {"mine"}) == (chosen[1:] if compiled else chosen)
    assert chosen_for(chosen, {"mine", "leakage"}) == chosen
    assert first_needed(chosen) == ([(), LIBRARY, chosen[1:]] if compiled else [(), chosen])
    assert first_needed(chosen[1:]) == [(), chosen[1:]]
    assert first_needed(chosen[:1]) == ([(), LIBRARY] if compiled else [(), chosen[:1]])


def test_the_gates_of_a_candidate_are_those_of_its_kernel(everything: dict) -> None:
    views = Views(Evidence(()), tuple(everything.values()))
    hardware = SimpleNamespace(values={}, effects={})
    for effect in ("leakage", "mine"):
        candidate = Candidate({}, {effect: {}})
        model = views.joint(candidate, hardware)
        p = views.vector(model, candidate, hardware)
        opened = [
            name for name, value in zip(model.composition.parameters, p, strict=True) if name.startswith("gate.") and value
        ]
        assert opened == [f"gate.{effect}"]
        present, _ = views._key(model, p, ("arm_reading",))
        assert present == {effect}


def test_what_is_missing_is_named_once_for_each_kernel(everything: dict, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []

    def compiled(source: str) -> bool:
        seen.append(source)
        return "mine" not in source

    monkeypatch.setattr(warm, "is_compiled", compiled)
    found = warm.missing(tuple(everything.values()))
    cuts = [cut.name for cut in PumpJoint.cuts if cut.driven]
    assert [given for _, _, given in found] == [(cut, ("gravity_load", "mine")) for cut in cuts]
    assert all("mine" in subject for subject, _, _ in found)
    assert len(set(seen)) == len(seen) == 3 * len(cuts)


def test_only_and_without_choose_the_effects() -> None:
    library = load_effects([])
    assert list(considered(library, "leakage, entrained_air", None)) == ["entrained_air", "leakage"]
    assert "presliding" not in considered(library, None, "presliding")
    assert list(considered(library, "leakage,presliding", "presliding")) == ["leakage"]
    assert set(considered(library, "leakage", None, {"encoder_lag": {}})) == {"leakage", "encoder_lag"}
    assert considered(library, None, None) == library


@pytest.mark.parametrize(
    ("only", "without", "message"),
    [
        ("leackage", None, r"unknown effect 'leackage'.*leakage"),
        (None, "stribek_friction", r"unknown effect 'stribek_friction'.*stribeck_friction"),
        (" , ", None, r"--only ' , ': give the names of effects"),
        ("leakage", "leakage", "--only leakage --without leakage leaves no effect to look for$"),
    ],
)
def test_a_choice_that_cannot_be_made_is_refused(only: str | None, without: str | None, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        considered(load_effects([]), only, without)
