"""Add effects to a model: fit them, save the model, and show the error fall on tests that were not used."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.analyses.data import Data
from hjcamp.commands.shared.session import AnswerFile, check_answer_file
from hjcamp.storage import named_file


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("add")(add)


def add(
    effects_and_paths: Annotated[
        list[str],
        typer.Argument(metavar="EFFECT... PATH...", help="Effects, then logs; or the folder of a table's diagnosis."),
    ],
    name: Annotated[str, typer.Option("--as", help="Name of the new model: conf/model/NAME.yaml.")],
    model: Annotated[str, typer.Option(help="The model to add to.")] = "published",
    json: AnswerFile = None,
) -> None:
    """Add effects to a model: fit them, save the model, and show the error fall on tests that were not used."""
    from hjcamp.commands.any_plant import calls
    from hjcamp.known_plants import usual_plant

    check_answer_file(json)
    named_file(name, "model", Path("conf") / "model")
    tables = usual_plant().own_room("tables")
    if len(effects_and_paths) == 1 and tables.is_answer(Path(effects_and_paths[0])):
        tables.add_table(Path(effects_and_paths[0]), name, json)
        return
    there = [Path(word) for word in effects_and_paths if Path(word).exists()]
    plant = Data(there).plant if there else usual_plant()
    (plant.room_of("add") or calls).add(there, effects_and_paths, name, model, json)
