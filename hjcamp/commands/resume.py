"""Go on with a run that was stopped: makes the tests that are missing, keeps those that are whole."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("resume")(resume)


def resume(
    run: Annotated[Path, typer.Argument(help="The run folder.")],
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; as many as pay off by default.")] = None,
    fail_fast: Annotated[bool, typer.Option("--fail-fast", help="Stop at the first test that fails.")] = False,
    keep_going: Annotated[
        bool, typer.Option("--keep-going", help="After a fault look at the rig again; go on where that passes.")
    ] = False,
    cluster: Annotated[str | None, typer.Option(help="A dask scheduler, tcp://HOST:PORT, or 'local'.")] = None,
) -> None:
    """Go on with a run that was stopped: makes the tests that are missing, keeps those that are whole."""
    from hjcamp.campaign.before import say_before_moving
    from hjcamp.campaign.conclude import conclude
    from hjcamp.campaign.console import make_console
    from hjcamp.campaign.folder import open_folder
    from hjcamp.campaign.going_on import StopRule
    from hjcamp.campaign.on_cluster import cluster_for
    from hjcamp.campaign.planning import check_plan
    from hjcamp.campaign.provenance import code_identity
    from hjcamp.campaign.runner import run_plan

    rule = StopRule(fail_fast, keep_going)
    console = make_console()
    folder = open_folder(run)
    check_plan(folder.plan, str(run / "plan.json"))
    say_before_moving(folder.plan, console)
    sessions = folder.manifest["sessions"]
    if sessions and any(sessions[-1].get(key) != value for key, value in code_identity().items()):
        console.print("the program has changed since this run began; old and new tests may differ", style="yellow")
    with cluster_for(cluster, folder.plan, "--cluster ") as client:
        result = run_plan(folder, console, workers, rule, cluster=client)
    conclude(folder, result, console)
