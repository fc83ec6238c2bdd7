"""Print the JSON schema of a file that you write, for an editor that completes and checks it."""

from __future__ import annotations

import json
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("schema")(schema)


def schema(
    name: Annotated[
        str, typer.Argument(help="Which file: campaign, map, model, rig, settings, or a group such as trajectory.")
    ],
    plant: Annotated[str | None, typer.Option(help="With the fields, parameters and effects of this plant.")] = None,
) -> None:
    """Print the JSON schema of a file that you write: hjcamp schema campaign > campaign.json.

    The line '# yaml-language-server: $schema=campaign.json' at the head of a file makes an editor use it; files that the program
    begins have it. settings: the whole configuration, as config.yaml of a run holds it.
    """
    from hjcamp.configuration.file_schemas import file_schema
    from hjcamp.known_plants import find_plant

    print(json.dumps(file_schema(name, find_plant(plant, "--plant") if plant else None), indent=1))
