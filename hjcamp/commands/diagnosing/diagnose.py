"""Say which physical effect the model misses, or that nothing is missing, or that these tests cannot tell."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.analyses.data import Data
from hjcamp.analyses.diagnosing import Asked, check_workers
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, folder_for, no_logs
from hjcamp.diagnosis.levels import ALPHA, DELTA
from hjcamp.errors import UsageError, unknown

METHODS = ("own", "common")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("diagnose")(diagnose)


def diagnose(
    paths: Annotated[list[Path] | None, typer.Argument(help="Run folders, folders of logs, or log files.")] = None,
    model: Annotated[str, typer.Option(help="The model to start from.")] = "published",
    tables: Annotated[
        str | None,
        typer.Option(help="Judge by tables instead: 5.4.1 and further ones, or a CSV file and campaign=NAME."),
    ] = None,
    held_out: Annotated[
        str | None, typer.Option("--held-out", help="Tables to predict, with commas; by default all that are not used.")
    ] = None,
    json: AnswerFile = None,
    effort: Annotated[str, typer.Option(help="quick, standard or thorough.")] = "standard",
    seed: Annotated[int, typer.Option(help="Seed of the simulated null replicates.")] = 1,
    workers: Annotated[
        int | None, typer.Option(help="Processes; every processor, 4 at most, by default. The answer is the same.")
    ] = None,
    cluster: Annotated[str | None, typer.Option(help="A dask scheduler, tcp://HOST:PORT, or 'local'.")] = None,
    only: Annotated[str | None, typer.Option(help="Effects to consider, with commas; all of them by default.")] = None,
    without: Annotated[str | None, typer.Option(help="Effects to leave out, with commas.")] = None,
    ask: Annotated[
        str | None, typer.Option(help="Effects that get a row whatever they explain, with commas; your own always do.")
    ] = None,
    method: Annotated[
        str,
        typer.Option(help="own or common: by the diagnosis of the plant's own, where it has one, or by that of any plant."),
    ] = "own",
    alpha: Annotated[
        float, typer.Option(help="The level of the whole answer: how often something is claimed where nothing is.")
    ] = ALPHA,
    delta: Annotated[float, typer.Option(help="The smallest share of the error above repeatability that matters.")] = DELTA,
) -> None:
    """Say which physical effect the model misses, or that nothing is missing, or that these tests cannot tell."""
    from hjcamp.commands.any_plant import calls
    from hjcamp.known_plants import usual_plant

    if method not in METHODS:
        raise unknown("method", method, METHODS, "--method")
    check_workers(workers)
    others = _unusual(alpha, delta)
    if tables is not None:
        _only_for_logs(others, "" if model == "published" else f"--model {model}")
        words = [tables, *map(str, paths or [])]
        usual_plant().own_room("tables").diagnose_tables(words, held_out, json, effort, seed, workers, only, without)
        return
    if held_out is not None:
        raise UsageError(f"--held-out {held_out}: it goes with --tables")
    if not paths:
        raise no_logs()
    check_answer_file(json)
    asked = Asked(model, effort, seed, only, without, workers, cluster, ask, alpha, delta)
    asked.check()
    data = Data(paths, common=method == "common")
    own = None if data.common else data.plant.room_of("diagnose")
    if own and others:
        raise UsageError(
            f"{others}: plant {data.plant_name} is judged at levels of its own; with --method common like any plant"
        )
    folder_for("diagnose", data.paths, json)  # a link in its place is refused before anything is computed
    (own or calls).diagnose(data, asked, json)


def _only_for_logs(*options: str) -> None:
    """Refuse what tables do not read: they are judged from the published model, at levels of their own."""
    for option in filter(None, options):
        raise UsageError(f"{option}: tables are judged from the published model, at levels of their own")


def _unusual(alpha: float, delta: float) -> str:
    """The first number of the decision that is not as usual, as it was asked; empty where both are."""
    changed = (("alpha", alpha, ALPHA), ("delta", delta, DELTA))
    return next((f"--{name} {value:g}" for name, value, usual in changed if value != usual), "")
