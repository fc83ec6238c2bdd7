"""A campaign of the user's, written by the program: its name, and its file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.known_plants import DEFAULT, find_plant
from hjcamp.storage import named_file, whole_file

FOLDER = Path("campaigns")


def new_campaign(name: str | None, folder: Path = FOLDER) -> Path:
    """Return the file of a new campaign; without a name the first of next_1, next_2 ... that is free.

    A name that is no name, or that exists here or among ours, is refused.
    """
    taken = {*Composer().options("campaign"), *(path.stem for path in folder.glob("*.yaml"))}
    if name is None:
        name = next(one for number in range(1, len(taken) + 2) if (one := f"next_{number}") not in taken)
    [path] = named_file(name, "campaign", folder)
    if name in taken:
        raise UsageError(f"campaign '{name}' exists already; choose another name after --as")
    return path


def write_campaign(path: Path, content: Mapping[str, Any], comment: Sequence[str]) -> None:
    """Write a campaign's YAML, whole or not at all."""
    from hjcamp.configuration.file_schemas import file_schema
    from hjcamp.schema import editor_line

    plant = find_plant((content.get("fixed") or {}).get("plant") or DEFAULT)
    line = editor_line(path, f"campaign_{plant.name}", file_schema("campaign", plant))
    text = yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True, width=110)
    with whole_file(path) as stream:
        stream.write((line + "".join(f"# {line}\n" for line in comment) + text).encode())
