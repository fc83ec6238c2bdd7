"""Effects added to a model of the joint, and the model saved."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hjcamp import __version__
from hjcamp.analyses.adding import Added, command_line
from hjcamp.analyses.data import Data, Report, silent
from hjcamp.errors import counted
from hjcamp.plants.pump_joint.analyses.evidence import evidence_in

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.diagnosis.add import Addition
    from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence


def add(data: Data, names: Sequence[str], name: str, model: str = "published", report: Report = silent) -> Added:
    """Fit the effects ``names`` in addition to the base of ``model`` and save the new model as ``conf/model/NAME.yaml``."""
    from hjcamp.configuration.saved_model import check_new_name, write_model
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint.diagnosis.add import add as fit_added
    from hjcamp.plants.pump_joint.diagnosis.add import answer, check_effects
    from hjcamp.plants.pump_joint.diagnosis.models.saved import saved_model
    from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
    from hjcamp.workers.pool import Crew, available

    library = load_effects()
    path = check_new_name(name)
    start = saved_model(model)
    check_effects(list(names), library, start, model)
    evidence = evidence_in(data)
    report(f"fitting {', '.join(names)}", 0.2)
    crew = Crew(available())
    try:
        found = fit_added(Views(evidence, tuple(library.values()), crew), start, list(names))
    finally:
        crew.close()
    content = answer(found, name, list(names), str(path))
    origin = provenance_of(found, evidence, command_line(data, names, name, model), content)
    write_model(path, found.candidate, comment_of(model, found), origin)
    return Added(found, content, path)


def comment_of(model: str, found: Addition) -> list[str]:
    """Return the first lines of the model's file."""
    parts = " + ".join([model, "calibration", *found.effects])
    times = "x noise floor" if found.scale.repeated else "x spread of the measurement"
    told = (found.start, found.before, found.after)
    errors = f"{' -> '.join(f'{one.score:.2f}' for one in told)} {times}"
    return [
        parts,
        f"Error on {counted(len(found.fold.held_out), 'test')} not used for the fit ({model}, calibrated, this): {errors}.",
        "SI units; 95 % intervals below, conditions left out one after the other.",
    ]


def provenance_of(found: Addition, evidence: Evidence, command: str, content: dict[str, Any]) -> dict[str, Any]:
    """Return where the model comes from: command, version, time, fit, intervals, logs by hash."""
    from hjcamp.campaign.files.provenance import git_label, utc_now
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
