"""Write a run as one zip archive that another computer checks and opens: hjcamp share RUN."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("share")(share)


def share(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="The run folder.")],
    output: Annotated[Path | None, typer.Option(help="The archive; RUN.zip here by default.")] = None,
) -> None:
    """Write a run as one zip archive (an RO-Crate): plan, configuration, logs, tables, each with its digest.

    Pages are left out, as what is received must not be a program: hjcamp report makes them again. hjcamp open ZIP unpacks it elsewhere.
    """
    from hjcamp.campaign.files.shared_run import share_run
    from hjcamp.errors import UsageError, counted
    from hjcamp.storage import check_place, shown_path

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
