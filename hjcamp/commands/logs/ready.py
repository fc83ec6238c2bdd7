"""Say whether measured tests can decide: what is wrong with them, and the smallest effects that they would show."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, no_logs, progress_of, write_answer
from hjcamp.errors import HjcampError, counted


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("ready")(ready)


def ready(
    paths: Annotated[list[Path] | None, typer.Argument(help="Run folders, folders of logs, or log files.")] = None,
    json: AnswerFile = None,
) -> None:
    """Say whether measured tests can decide: what is wrong with them, and the smallest effects that they would show.

    Clock, gaps, columns, copies, saturation, quantisation, repetitions, excitation, identifiable parameters. The exit code is 0 where
    nothing is to be said against them, 1 else.
    """
    from hjcamp.analyses.data import Data
    from hjcamp.analyses.readiness import readiness
    from hjcamp.campaign.execution.console import make_console

    if not paths:
        raise no_logs()
    check_answer_file(json)
    data = Data(paths, common=True)
    with progress_of(make_console()) as report:
        found = readiness(data, report)
    write_answer(json, found.content(data.plant_name))
    for one in found.remarks:
        print(f"{one.check}: {one.text}; {one.consequence}")
    if found.smallest:
        print("smallest amplitude that these tests would show, and the usual one:")
        for row in found.smallest:
            size = f"{row.amplitude:.3g}" if row.amplitude == row.amplitude else "none"
            print(f"  {row.effect:28} {row.parameter:24} {size:>10} {row.usual:>10.3g} {row.unit}")
    if not found.ready:
        raise HjcampError(f"not ready: {counted(len(found.remarks), 'remark')}")
    print("ready")
