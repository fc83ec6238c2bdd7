"""Saved models of any plant: ``conf/model/NAME.yaml`` with the plant's name, base parameters and effects, SI."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hjcamp.configuration.saved_model import FOLDER
from hjcamp.errors import UsageError, unknown
from hjcamp.model.candidate import Candidate
from hjcamp.model.effect import Effect
from hjcamp.model.plant import Plant
from hjcamp.prediction.windows import DELAY, ZERO
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
    return Candidate(_base(content, plant, path), _effects(content, plant, library, path))


def savable(candidate: Candidate) -> Candidate:
    """Return a candidate without what is of these logs alone: where their counters begin to count."""
    return Candidate({k: v for k, v in candidate.base.items() if not k.startswith(ZERO)}, candidate.effects)


def _base(content: Mapping[str, Any], plant: type[Plant], path: Path) -> dict[str, float]:
    given = content.get("parameters") or {}
    if not isinstance(given, Mapping):
        raise UsageError(f"{path}: parameters is a mapping of names to values in SI units")
    found = {}
    for key, value in given.items():
        name = str(key)
        if name.startswith(DELAY) and name.removeprefix(DELAY) in plant.inputs:
            found[name] = _number(value, f"{path}: parameters.{name}")
        elif name in plant.parameters:
            found[name] = plant.parameters[name].checked(value, f"{path}: parameters.{name}")
        else:
            raise unknown("parameter", name, plant.parameters, f"{path}: parameters")
    return found


def _number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= float(value) < 1e6:
        raise UsageError(f"{where} is {value!r:.40}; a delay of 0 or more in seconds is needed")
    return float(value)


def _effects(
    content: Mapping[str, Any], plant: type[Plant], library: Mapping[str, type[Effect]], path: Path
) -> dict[str, dict[str, float]]:
    given = content.get("effects") or {}
    if not isinstance(given, Mapping):
        raise UsageError(f"{path}: effects is a mapping of effects to their parameters")
    found = {}
    for name, values in given.items():
        if name not in library:
            raise unknown("effect", str(name), library, f"{path}: effects, plant {plant.name}")
        if not isinstance(values or {}, Mapping):
            raise UsageError(f"{path}: effects.{name} is a mapping of parameters to values in SI units")
        found[str(name)] = library[name].checked(values or {}, f"{path}: effects")
    return found
