"""Saved models of any plant: ``conf/model/NAME.yaml`` with the plant's name, base parameters and effects, SI."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hjcamp.configuration.saved_model import FOLDER
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.effects import chosen_effects
from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.base_values import checked_base, period_of
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import Plant
from hjcamp.storage import named_file
from hjcamp.yaml_file import read_yaml

DECLARED = "published"


def load_model(name: str, plant: type[Plant], library: Mapping[str, type[Effect]]) -> Candidate:
    """Return a saved model of the plant; ``published`` is the plant as its file declares it.

    Raises ``UsageError`` for a model that is not there, of another plant, or with values that cannot be.
    """
    if name == DECLARED:
        return Candidate({}, {})
    [path] = named_file(name, "model", FOLDER)
    if not path.is_file():
        known = [DECLARED, *sorted(one.stem for one in FOLDER.glob("*.yaml"))]
        raise unknown("model", name, known)
    content = read_yaml(path)
    if not isinstance(content, Mapping):
        raise UsageError(f"{path}: a model is a mapping with plant, parameters and effects")
    other = content.get("plant", "pump_joint")
    if other != plant.name:
        raise UsageError(f"{path}: a model of plant {other}; these tests are of plant {plant.name}")
    return Candidate(
        checked_base(content.get("parameters"), plant, f"{path}: parameters"), _effects(content, plant, library, path)
    )


def savable(candidate: Candidate) -> Candidate:
    """Return a candidate without what is of these logs alone: where their counters begin to count."""
    return Candidate({k: v for k, v in candidate.base.items() if not k.startswith(ZERO)}, candidate.effects)


def _effects(
    content: Mapping[str, Any], plant: type[Plant], library: Mapping[str, type[Effect]], path: Path
) -> dict[str, dict[str, float]]:
    given = content.get("effects") or {}
    if not isinstance(given, Mapping):
        raise UsageError(f"{path}: effects is a mapping of effects to their parameters")
    for name, values in given.items():
        if name not in library:
            raise unknown("effect", str(name), library, f"{path}: effects, plant {plant.name}")
        if not isinstance(values or {}, Mapping):
            raise UsageError(f"{path}: effects.{name} is a mapping of parameters to values in SI units")
    period = period_of(content, f"{path}: model")
    return chosen_effects(given, f"{path}: effects", plant, period)[1]
