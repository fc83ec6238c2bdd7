"""Go on with a run that was stopped: makes the tests that are missing, keeps those that are whole."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.errors import UsageError


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("resume")(resume)


def resume(
    run: Annotated[Path, typer.Argument(help="The run folder.")],
    workers: Annotated[int | None, typer.Option(min=1, max=1024, help="Processes; as many as pay off by default.")] = None,
    fail_fast: Annotated[bool, typer.Option("--fail-fast", help="Stop at the first test that fails.")] = False,
    keep_going: Annotated[
        bool, typer.Option("--keep-going", help="After a fault look at the rig again; go on where that passes.")
    ] = False,
    cluster: Annotated[str | None, typer.Option(help="A dask scheduler, tcp://HOST:PORT, or 'local'.")] = None,
    live: Annotated[bool, typer.Option("--live", help="Open a page that follows the run, on this computer alone.")] = False,
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port of the page; 0: one that is free.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Show the page to a browser.")] = True,
) -> None:
    """Go on with a run that was stopped: makes the tests that are missing, keeps those that are whole."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.execution.stop_rule import StopRule
    from hjcamp.campaign.files.run_folder import open_folder
    from hjcamp.campaign.one_run import finish_run
    from hjcamp.commands.shared.live import live as live_of
    from hjcamp.live.process import LiveAsk

    if port and not live:
        raise UsageError(f"--port {port} is for the page of --live; give both")
    with live_of(LiveAsk(port, browser) if live else None):
        finish_run(open_folder(run), make_console(), workers, StopRule(fail_fast, keep_going), cluster)
