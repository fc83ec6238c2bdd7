"""Write the proposed tests as a campaign that runs as it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.configuration.composer import Composer
from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.diagnosis.design.menu import Choice
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


def allowed_by(choices: Sequence[Choice], fixed: Mapping[str, Any]) -> list[Choice]:
    """Return the tests of the menu that do not contradict what the user has fixed."""
    return [one for one in choices if all(one.settings.get(key, value) == value for key, value in fixed.items())]


def campaign_content(
    name: str, description: str, fixed: Mapping[str, Any], choices: Sequence[Choice], repetitions: int
) -> dict[str, Any]:
    """Return the content of the campaign's file; a key that any test sets itself is given to every test."""
    own = {key for one in choices for key in one.settings}
    shared = {key: value for key, value in fixed.items() if key not in own}
    given = {key: value for key, value in fixed.items() if key in own}
    cases = {one.name: {**given, **one.settings} for one in choices}
    return {
        "name": name,
        "description": description,
        "fixed": shared,
        "vary": {"test": cases},
        "repetitions": repetitions,
        "tables": [],
    }


def write_campaign(path: Path, content: Mapping[str, Any], comment: Sequence[str]) -> None:
    """Write a campaign's YAML, whole or not at all."""
    import yaml

    text = yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True, width=110)
    with whole_file(path) as stream:
        stream.write(("".join(f"# {line}\n" for line in comment) + text).encode())
