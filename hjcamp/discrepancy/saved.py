"""Models by name: read one as a candidate, write a new one with where it comes from."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.discrepancy.evidence import Evidence
from hjcamp.discrepancy.unknowns import base_unknowns
from hjcamp.errors import UsageError
from hjcamp.model.candidate import Candidate
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.storage import named_file, whole_file

FOLDER = Path("conf") / "model"


def saved_model(name: str) -> Candidate:
    """Return the saved model ``name``: its plant parameters and effects, SI; unknown names are refused."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.effects import chosen_effects

    content = Composer().model(name)
    _, effects = chosen_effects(content["effects"])
    return Candidate({key: float(value) for key, value in content["parameters"].items()}, effects)


def complete(candidate: Candidate, evidence: Evidence) -> Candidate:
    """Return the candidate with every base parameter given: the hardware's value where the model has none."""
    values = evidence.tests[0].hardware.values
    names = [one.name for one in base_unknowns()]
    published = {name: values.get(name, PumpJoint.parameters[name].default) for name in names}
    return Candidate({**published, **candidate.base}, candidate.effects)


def check_new_name(name: str, folder: Path = FOLDER) -> Path:
    """Return the file of a new model; refuse a name that is no name or that exists, here or among ours."""
    from hjcamp.configuration.composer import Composer

    [path] = named_file(name, "model", folder)
    if path.exists() or name in Composer().options("model"):
        raise UsageError(f"model '{name}' exists already; choose another name after --as")
    return path


def write_model(path: Path, candidate: Candidate, comment: Sequence[str], provenance: Mapping[str, Any]) -> None:
    """Write a model's YAML whole or not at all: parameters and effects in SI, then its provenance."""
    import yaml

    content = {
        "name": path.stem,
        "parameters": {name: float(f"{value:.7g}") for name, value in candidate.base.items()},
        "effects": {
            name: {key: float(f"{value:.7g}") for key, value in given.items()}
            for name, given in candidate.effects.items()
        },
        "provenance": dict(provenance),
    }
    head = "".join(f"# {line}\n" for line in comment)
    text = head + yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=110)
    with whole_file(path) as stream:
        stream.write(text.encode())


def log_hashes(evidence: Evidence) -> dict[str, str]:
    """Return the SHA-256 of every log file by its path."""
    found = {}
    for test in evidence.tests:
        if test.log.path is not None:
            with test.log.path.open("rb") as stream:
                found[test.log.path.as_posix()] = hashlib.file_digest(stream, "sha256").hexdigest()
    return found
