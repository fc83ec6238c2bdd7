"""Propose the tests that best separate the explanations that remain, as a campaign that runs as it is."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands.shared.session import check_answer_file, folder_for
from hjcamp.errors import UsageError
from hjcamp.known_plants import DEFAULT, usual_plant

MOST_TESTS = 12


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("next")(next_)


def next_(
    words: Annotated[
        list[str] | None,
        typer.Argument(metavar="[PATH...] [KEY=VALUE...]", help="Logs (none: before the first test), and what is fixed."),
    ] = None,
    rivals: Annotated[list[str] | None, typer.Option(help="Effects to set apart: A,B. 'nothing' can be one.")] = None,
    tests: Annotated[int, typer.Option(help="How many tests to propose.")] = 3,
    name: Annotated[str | None, typer.Option("--as", help="Name of the campaign: campaigns/NAME.yaml.")] = None,
    json: Annotated[Path | None, typer.Option(help="Write the answer for programs to this file; - is standard output.")] = None,
    effort: Annotated[str, typer.Option(help="Effort of the diagnosis: quick, standard or thorough.")] = "standard",
    workers: Annotated[int | None, typer.Option(help="Workers of the diagnosis; the number of processors by default.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of everything that is simulated.")] = 1,
    model: Annotated[
        str, typer.Option(help=f"The model to start from, for logs of another plant than {DEFAULT}.")
    ] = "published",
    signals: Annotated[
        Path | None,
        typer.Option(help="Write the tests as CSV for another rig into this folder, with the map for their import."),
    ] = None,
) -> None:
    """Propose the tests that best separate the explanations that remain, as a campaign that runs as it is."""
    from hjcamp.analyses.data import Data
    from hjcamp.analyses.diagnosing import Asked
    from hjcamp.campaign.plan.new_file import new_campaign
    from hjcamp.commands.any_plant import calls

    check_answer_file(json)
    if not 1 <= tests <= MOST_TESTS:
        raise UsageError(f"--tests {tests}: give a number from 1 to {MOST_TESTS}")
    asked = Asked(model, effort, seed, workers=workers)
    asked.check()
    path = new_campaign(name)
    logs = [Path(word) for word in words or [] if "=" not in word and Path(word).exists()]
    plant = Data(logs).plant if logs else usual_plant()
    if signals is not None:
        from hjcamp.analyses.signals import check_signals

        check_signals(plant, signals)
    folder_for("next", logs, json)  # a link in its place is refused before anything is computed
    (plant.room_of("next") or calls).propose(logs, words or [], rivals or [], tests, asked, name, json)
    if signals is not None:
        from hjcamp.commands.campaigns.plan import compose_plan, tell_signals

        if not path.is_file():
            raise UsageError(f"--signals {signals}: no campaign was written, as these tests are no course of one input")
        tell_signals(compose_plan([f"campaign={path.stem}"]), signals)
