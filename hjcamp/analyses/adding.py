"""Effects added to a model, and the model saved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report, joined, silent
from hjcamp.errors import UsageError, counted

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect


@dataclass(frozen=True)
class Added:
    """A model with effects added: what the fit found, the answer for programs, the model's file."""

    found: Any
    content: dict[str, Any]
    path: Path


def library_of_data(data: Data) -> Mapping[str, type[Effect]]:
    """Return the effects that the plant of these tests can have."""
    from hjcamp.effects import load_effects

    return load_effects(plant=data.measured.plant)


def add(data: Data, names: Sequence[str], name: str, model: str = "published", report: Report = silent) -> Added:
    """Fit the effects ``names`` in addition to the base of ``model`` and save the new model as ``conf/model/NAME.yaml``."""
    from hjcamp.configuration.saved_model import check_new_name, write_model
    from hjcamp.diagnosis.results.addition import added, answer, provenance
    from hjcamp.diagnosis.results.model_file import load_model, savable
    from hjcamp.effects import library_of

    library = library_of_data(data)
    measured = data.measured
    path = check_new_name(name)
    start = load_model(model, measured.plant, library)
    for one in names:
        if one not in library:
            # says why, where the effect is one that does not fit this plant
            library_of(measured.plant).find(one)
        if one in start.effects:
            raise UsageError(f"effect {one}: model '{model}' has it already")
    if len(set(names)) < len(names):
        raise UsageError(f"hjcamp add {' '.join(names)}: each effect once")
    report("compiling, once for these effects", 0.05)
    found = added(measured, library, start, list(names), report)
    form = [one for one in found.model.names if one not in (*names, *start.effects)]
    seen = f" and the form of its contacts ({', '.join(form)})" if form else ""
    tests = counted(len(measured.tests), "test")
    comment = [f"{model} with {', '.join(names)}{seen}, fitted to {tests} of plant {measured.plant.name}"]
    origin = provenance(found, command_line(data, names, name, model))
    write_model(path, savable(found.model.fitted.candidate), comment, origin, measured.plant)
    return Added(found, answer(found, name, str(path)), path)


def command_line(data: Data, names: Sequence[str], name: str, model: str) -> str:
    """Return the call of ``hjcamp add`` that does the same."""
    return f"hjcamp add {' '.join(names)} {joined(data.paths)} --model {model} --as {name}"
