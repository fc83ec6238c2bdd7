"""List runs, newest first; filter them with KEY=VALUE (campaign, state, payload, git, any parameter)."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.errors import UsageError
from hjcamp.storage import shown_path


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("ls")(ls)


def ls(
    filters: Annotated[list[str] | None, typer.Argument(metavar="KEY=VALUE")] = None,
    folder: Annotated[Path | None, typer.Option(help="Where to look; runs and multirun by default.")] = None,
) -> None:
    """List runs, newest first; filter them with KEY=VALUE (campaign, state, payload, git, any parameter)."""
    from rich.table import Table

    from hjcamp.campaign.console import make_console
    from hjcamp.campaign.finding import FOLDERS, find_runs

    if folder is not None and not folder.is_dir():
        raise UsageError(f"--folder {shown_path(folder)}: there is no such folder")
    runs = find_runs([folder] if folder else FOLDERS, filters or [])
    console = make_console()
    if not runs:
        console.print(
            "no runs found" + (" that meet the filters" if filters else "; the first: hjcamp run campaign=NAME")
        )
        return
    table = Table(box=None, header_style="bold")
    for name in ("run", "campaign", "state", "tests", "started"):
        table.add_column(name, no_wrap=name != "run", overflow="fold")
    for run in runs:
        tests = f"{run.done}/{len(run.plan.tests)}"
        table.add_row(str(run.path), run.plan.campaign, run.state, tests, run.started)
    console.print(table)
