"""Write a run as one zip archive that another computer checks and opens: hjcamp share RUN."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.errors import UsageError, counted
from hjcamp.storage import check_place, shown_path


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("share")(share)


def share(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="The run folder.")],
    output: Annotated[Path | None, typer.Option(help="The archive; RUN.zip here by default.")] = None,
    mlflow: Annotated[
        str | None,
        typer.Option(help="Instead: into this MLflow store, sqlite:///FILE or an address (extra 'mlflow')."),
    ] = None,
) -> None:
    """Write a run as one zip archive (an RO-Crate): plan, configuration, logs, tables, each with its digest.

    --mlflow: parameters, means of the indicators, tables and page go into a tracking store, the same run once.

    Of the archive pages are left out, as what is received must not be a program: hjcamp report makes them again. hjcamp open ZIP
    unpacks it elsewhere.
    """
    from hjcamp.campaign.files.shared_run import share_run

    if mlflow is not None:
        from hjcamp.campaign.files.mlflow_run import track

        if output is not None:
            raise UsageError("give --mlflow STORE or --output FILE.zip, not both")
        identity, new = track(run, mlflow)
        print(f"{mlflow}: run {identity}{'' if new else ', which was there already'}")
        return
    name = run.resolve().name
    target = output or Path(f"{name}.zip")
    if target.suffix.lower() != ".zip":
        raise UsageError(f"--output {shown_path(target)}: give a name that ends in .zip")
    check_place(target, "--output" if output else "")
    if target.exists():
        raise UsageError(f"{shown_path(target)}: exists already; delete it, or give another name: --output FILE.zip")
    files, left_out = share_run(run, target)
    more = f"; {counted(len(left_out), 'page or picture', 'pages and pictures')} left out" if left_out else ""
    print(f"{target}: {counted(files, 'file')}{more}")
    print(f"next  elsewhere: hjcamp open {target.name}")
