"""Identify a rig's constants from its own logs and save them as configuration."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.analyses.data import Data
from hjcamp.commands.shared.session import AnswerFile, check_answer_file
from hjcamp.errors import UsageError


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("calibrate")(calibrate)


def calibrate(
    paths: Annotated[list[Path], typer.Argument(help="Run folders, folders of logs, or log files.")],
    name: Annotated[str, typer.Option("--as", help="Name of the model and rig to write: conf/model/NAME.yaml.")],
    only: Annotated[
        list[str] | None, typer.Option(help="Only logs with this in their metadata, KEY=VALUE. May be repeated.")
    ] = None,
    conf: Annotated[Path, typer.Option(help="Configuration folder to write into.")] = Path("conf"),
    replace: Annotated[bool, typer.Option("--replace", help="Replace files of that name.")] = False,
    profile: Annotated[
        bool,
        typer.Option("--profile", help="Intervals by likelihood ratio, drawn on a page; says what the tests do not bound."),
    ] = False,
    stability: Annotated[
        bool,
        typer.Option(
            "--stability", help="Calibrate again with other window lengths and without each test: what depends on it."
        ),
    ] = False,
    posterior: Annotated[
        Path | None, typer.Option(help="Write draws from the posterior to this netCDF file, for arviz (extra 'posterior').")
    ] = None,
    json: AnswerFile = None,
) -> None:
    """Identify a rig's constants from its own logs and save them as configuration."""
    from hjcamp.commands.any_plant import calls
    from hjcamp.commands.any_plant.uncertainty import Further
    from hjcamp.configuration.saved_model import check_name

    check_answer_file(json)
    check_name(name, conf, replace)
    data = Data(paths)
    room = data.plant.room_of("calibrate")
    if room is None:
        calls.calibrate_further(data, name, only or [], json, Further(profile, stability, posterior))
        return
    if profile or stability or posterior is not None:
        option = "--profile" if profile else "--stability" if stability else "--posterior"
        raise UsageError(
            f"{option}: plant {data.plant_name} is calibrated test by test, without one likelihood; it is of other plants"
        )
    room.calibrate(data, name, only or [], conf, replace, json)
