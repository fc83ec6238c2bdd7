"""Replay measured tests with one or more models: the error, its noise floor, and where it comes from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.analyses.comparing import check_models
from hjcamp.analyses.data import Data
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, folder_for, no_logs
from hjcamp.storage import check_place


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("compare")(compare)


def compare(
    paths: Annotated[list[Path] | None, typer.Argument(help="Run folders, folders of logs, or log files.")] = None,
    model: Annotated[list[str] | None, typer.Option(help="A saved model; may be repeated.")] = None,
    json: AnswerFile = None,
    into: Annotated[Path | None, typer.Option(help="The folder of the page; compare, next to the logs, by default.")] = None,
    tables: Annotated[
        str | None,
        typer.Option(help="Compare with tables instead: 5.4.1 and further ones, or a CSV file and campaign=NAME."),
    ] = None,
    mcap: Annotated[
        Path | None, typer.Option(help="Write each test with models and residuals as topics into this folder.")
    ] = None,
) -> None:
    """Replay measured tests with one or more models: the error, its noise floor, and where it comes from."""
    from hjcamp.commands.any_plant import calls
    from hjcamp.known_plants import usual_plant

    names = model or ["published"]
    check_models(names)
    if tables is not None:
        usual_plant().own_room("tables").compare_tables([tables, *map(str, paths or [])], names, json)
        return
    if not paths:
        raise no_logs()
    check_answer_file(json)
    if into is not None:
        check_place(into, "--into", folder=True)
    if mcap is not None:
        check_place(mcap, "--mcap", folder=True)
    data = Data(paths)
    if into is None:
        folder_for("compare", data.paths, json)  # a link in its place is refused before anything is computed
    (data.plant.room_of("compare") or calls).compare(data, names, json, into, mcap)
