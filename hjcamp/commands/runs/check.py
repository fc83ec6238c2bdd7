"""Hold a run against a baseline, course by course, for any plant; exit code 1 where it differs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import HjcampError, UsageError, counted
from hjcamp.storage import check_place, whole_file


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("check")(check)


def check(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder, or a folder of logs.")],
    against: Annotated[Path, typer.Option(help="The baseline: a run folder, or a folder of logs.")],
    tolerance: Annotated[float, typer.Option(help="How far each course may be off: rms, as a share of what it covers.")] = 0.01,
    junit: Annotated[Path | None, typer.Option(help="Write a test case for each course to this XML file.")] = None,
    json: AnswerFile = None,
) -> None:
    """Hold a run against a baseline: each course of each condition, the mean of its repetitions, for any plant.

    The exit code is 1 where a course differs by more than the tolerance, or is missing on either side.
    """
    from hjcamp.report.run_check import differences
    from hjcamp.report.run_check import junit as junit_of

    check_answer_file(json)
    if not 0.0 <= tolerance < 1.0:
        raise UsageError(f"--tolerance {tolerance:g}: give a share from 0 to 1, for example 0.01")
    if junit is not None:
        check_place(junit, "--junit")
    found = list(differences(run, against))
    failed = [one for one in found if not one.within(tolerance)]
    rows = [
        {
            "condition": one.condition,
            "field": one.field,
            "rms": one.rms if math.isfinite(one.rms) else None,
            "range": one.range if math.isfinite(one.range) else None,
            "share": one.share if math.isfinite(one.share) else None,
            "within": one.within(tolerance),
            "text": one.text,
        }
        for one in found
    ]
    write_answer(json, {"schema": "hjcamp.run_check/1", "tolerance": tolerance, "within": not failed, "courses": rows})
    if junit is not None:
        with whole_file(junit) as stream:
            stream.write(junit_of(found, tolerance).encode())
    for one in failed:
        print(f"{one.condition}: {f'{one.field!r} ' if one.field else ''}{one.text}")
    if failed:
        raise HjcampError(
            f"{len(failed)} of {counted(len(found), 'course')} differ by more than {tolerance:.3g} from {against}"
        )
    print(f"{counted(len(found), 'course')} within {tolerance:.3g} of {against}")
