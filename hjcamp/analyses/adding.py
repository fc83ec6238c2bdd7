"""Effects added to a model, and the model saved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report, joined, silent
from hjcamp.errors import UsageError, counted

if TYPE_CHECKING:
    from hjcamp.model.effect import Effect
    from hjcamp.plants.pump_joint.diagnosis.add import Addition as PumpAddition
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
    from hjcamp.prediction.addition import Addition as PlantAddition


@dataclass(frozen=True)
class Added:
    """A model with effects added: what the fit found, the answer for programs, the model's file."""

    found: PumpAddition | PlantAddition
    content: dict[str, Any]
    path: Path


def library_of_data(data: Data) -> Mapping[str, type[Effect]]:
    """Return the effects that the plant of these tests can have."""
    from hjcamp.effects import load_effects

    return load_effects() if data.of_pump_joint else load_effects(plant=data.measured.plant)


def add(data: Data, names: Sequence[str], name: str, model: str = "published", report: Report = silent) -> Added:
    """Fit the effects ``names`` beside the base of ``model`` and save the new model as ``conf/model/NAME.yaml``."""
    return (_add_pump_joint if data.of_pump_joint else _add_plant)(data, list(names), name, model, report)


def _add_pump_joint(data: Data, names: list[str], name: str, model: str, report: Report) -> Added:
    from hjcamp.configuration.saved_model import check_new_name, write_model
    from hjcamp.plants.pump_joint.diagnosis.add import add as fit_added
    from hjcamp.plants.pump_joint.diagnosis.add import answer, check_effects
    from hjcamp.plants.pump_joint.diagnosis.models.saved import saved_model
    from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
    from hjcamp.workers.pool import Crew, available

    library = library_of_data(data)
    path = check_new_name(name)
    start = saved_model(model)
    check_effects(names, library, start, model)
    evidence = data.evidence
    report(f"fitting {', '.join(names)}", 0.2)
    crew = Crew(available())
    try:
        found = fit_added(Views(evidence, tuple(library.values()), crew), start, names)
    finally:
        crew.close()
    content = answer(found, name, names, str(path))
    origin = provenance_of(found, evidence, _command(data, names, name, model), content)
    write_model(path, found.candidate, comment_of(model, found), origin)
    return Added(found, content, path)


def _add_plant(data: Data, names: list[str], name: str, model: str, report: Report) -> Added:
    from hjcamp.configuration.saved_model import check_new_name, write_model
    from hjcamp.effects import library_of
    from hjcamp.prediction.addition import added, answer, provenance
    from hjcamp.prediction.model_file import load_model, savable

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
    found = added(measured, library, start, names, report)
    form = [one for one in found.model.names if one not in (*names, *start.effects)]
    seen = f" and the form of its contacts ({', '.join(form)})" if form else ""
    tests = counted(len(measured.tests), "test")
    comment = [f"{model} with {', '.join(names)}{seen}, fitted to {tests} of plant {measured.plant.name}"]
    origin = provenance(found, _command(data, names, name, model))
    write_model(path, savable(found.model.fitted.candidate), comment, origin, measured.plant)
    return Added(found, answer(found, name, str(path)), path)


def _command(data: Data, names: Sequence[str], name: str, model: str) -> str:
    return f"hjcamp add {' '.join(names)} {joined(data.paths)} --model {model} --as {name}"


def comment_of(model: str, found: PumpAddition) -> list[str]:
    """Return the first lines of the model's file."""
    parts = " + ".join([model, "calibration", *found.effects])
    times = "x floor" if found.scale.repeated else "x spread of the measurement"
    told = (found.start, found.before, found.after)
    errors = f"{' -> '.join(f'{one.score:.2f}' for one in told)} {times}"
    return [
        parts,
        f"Error on {counted(len(found.fold.held_out), 'test')} not used for the fit ({model}, calibrated, this): {errors}.",
        "SI units; 95 % intervals below, conditions left out one after the other.",
    ]


def provenance_of(found: PumpAddition, evidence: Evidence, command: str, content: dict[str, Any]) -> dict[str, Any]:
    """Return where the model comes from: command, version, time, fit, intervals, logs by hash."""
    from hjcamp import __version__
    from hjcamp.campaign.provenance import git_label, utc_now
    from hjcamp.configuration.saved_model import log_hashes

    intervals = {key: [float(f"{end:.5g}") for end in row["ci95"]] for key, row in found.calibration.items()}
    for effect, rows in found.effects.items():
        ends = {key: [float(f"{end:.5g}") for end in row["ci95"]] for key, row in rows.items()}
        intervals.update({f"{effect}.{key}": value for key, value in ends.items()})
    return {
        "command": command,
        "version": __version__,
        "git": git_label(),
        "made_at": utc_now(),
        "tests_fitted": len(found.fold.train),
        "tests_held_out": [evidence.tests[index].name for index in found.fold.held_out],
        "heldout_error_over_floor": {
            key: None if value is None else round(value, 4) for key, value in content["error"].items()
        },
        "helps": found.helps,
        "ci95": intervals,
        "logs_sha256": log_hashes(test.log.path for test in evidence.tests),
    }
