"""New models in ``conf/model``: a name that is free, and a file with a comment, written whole or not at all."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.known_plants import find_plant, usual_plant
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.plant import Plant
from hjcamp.storage import named_file, whole_file

FOLDER = Path("conf") / "model"
RESERVED = ("published", "virtual")


def check_new_name(name: str, folder: Path = FOLDER) -> Path:
    """Return the file of a new model; refuse a name that is no name or that exists, here or among ours."""
    [path] = named_file(name, "model", folder)
    if path.exists() or name in Composer().options("model"):
        raise UsageError(f"model '{name}' exists already; choose another name after --as")
    return path


def check_name(name: str, folder: Path, replace: bool) -> None:
    """Raise UsageError where the name cannot be that of a choice, is ours, or is taken in ``folder`` (conf)."""
    paths = named_file(name, "model or rig", *(path.parent for path in paths_of(name, folder)))
    if name in RESERVED:
        raise UsageError(f"'{name}' is a model or rig of hjcamp's own; choose another name")
    for path in paths:
        if path.exists() and not replace:
            raise UsageError(f"{path} exists; choose another name, or say --replace")


def paths_of(name: str, folder: Path) -> tuple[Path, Path]:
    """Return where the model and its rig go."""
    return folder / "model" / f"{name}.yaml", folder / "rig" / f"{name}.yaml"


def write_model(
    path: Path, candidate: Candidate, comment: Sequence[str], provenance: Mapping[str, Any], plant: type[Plant] | None = None
) -> None:
    """Write a model: parameters and effects in SI, then its provenance; a ``plant`` as the logs sample it, but the usual one."""
    content = {
        **({"plant": plant.name, "period_s": plant.period} if plant else {}),
        "parameters": candidate.base,
        "effects": candidate.effects,
    }
    write_content(path, rounded(content), comment, provenance)


def write_content(
    path: Path, content: Mapping[str, Any], comment: Sequence[str], provenance: Mapping[str, Any]
) -> dict[str, Any]:
    """Write what a model holds with its name and provenance, and return all of it; refuse a name that was taken meanwhile."""
    from hjcamp.configuration.file_schemas import file_schema
    from hjcamp.schema import editor_line

    check_new_name(path.stem, path.parent)
    whole = {"name": path.stem, **content, "provenance": dict(provenance)}
    of = find_plant(str(content["plant"])) if content.get("plant") else usual_plant()
    line = editor_line(path, f"model_{of.name}", file_schema("model", of))
    head = line + "".join(f"# {one}\n" for one in comment)
    with whole_file(path) as stream:
        stream.write((head + yaml.safe_dump(whole, sort_keys=False, allow_unicode=True, width=110)).encode())
    return whole


def rounded(value: Any) -> Any:
    """Return nested numbers with seven digits."""
    if isinstance(value, Mapping):
        return {key: rounded(one) for key, one in value.items()}
    return float(f"{value:.7g}") if isinstance(value, float) else value


def log_hashes(paths: Iterable[Path | None]) -> dict[str, str]:
    """Return the SHA-256 of every log file by its path; logs that are in no file have none."""
    found = {}
    for path in paths:
        if path is not None:
            with path.open("rb") as stream:
                found[path.as_posix()] = hashlib.file_digest(stream, "sha256").hexdigest()
    return found
