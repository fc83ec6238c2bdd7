"""Print the JSON schema of a file that you write, for an editor that completes and checks it."""

from __future__ import annotations

from typing import Annotated

import typer

NAMES = ("map",)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("schema")(schema)


def schema(
    name: Annotated[str, typer.Argument(help="Which file: map.")],
    plant: Annotated[str | None, typer.Option(help="With the fields of this plant.")] = None,
) -> None:
    """Print the JSON schema of a file that you write: hjcamp schema map > map.json.

    The line '# yaml-language-server: $schema=map.json' at the head of a map makes an editor use it.
    """
    import json

    from hjcamp.errors import unknown
    from hjcamp.known_plants import find_plant
    from hjcamp.records.elsewhere.map_schema import map_schema

    if name not in NAMES:
        raise unknown("file", name, NAMES)
    print(json.dumps(map_schema(find_plant(plant, "--plant") if plant else None), indent=1))
