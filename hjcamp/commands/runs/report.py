"""Make tables and the report page of a run folder or of logs, next to the published values."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import HjcampError, UsageError, counted
from hjcamp.storage import check_place, own_folder

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.records.log import TestLog
    from hjcamp.report.build import Report

SHOWN = 20


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("report")(report)


def report(
    path: Annotated[Path, typer.Argument(help="A run folder or a folder of logs.")],
    against: Annotated[
        str | None, typer.Option(help="What is shown next to it: published, or another run folder.")
    ] = "published",
    check: Annotated[
        str | None, typer.Option(help="Fail where a mean is outside these tolerances: a YAML file, or default.")
    ] = None,
    summary: Annotated[Path | None, typer.Option(help="Write a summary in Markdown to this file, for a CI job's page.")] = None,
    junit: Annotated[Path | None, typer.Option(help="Write the check as JUnit XML to this file; with --check.")] = None,
    output: Annotated[Path | None, typer.Option(help="Another folder for tables and page.")] = None,
    template: Annotated[Path | None, typer.Option(help="Make the page by this template of yours (docs/templates.md).")] = None,
    repetition: Annotated[
        int | None, typer.Option(help="Draw this repetition of each condition alone, into repetition_N of the folder.")
    ] = None,
    json: AnswerFile = None,
) -> None:
    """Make tables and the report page of a run folder or of logs, next to the published values."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.further_pictures import further_pictures
    from hjcamp.report.answer import report_answer
    from hjcamp.report.build import build_report
    from hjcamp.report.check import check as check_cells
    from hjcamp.report.check import read_tolerances
    from hjcamp.report.ci import junit_xml, summary_markdown
    from hjcamp.report.reading import AGAINST
    from hjcamp.report.tables.store import replace_file

    check_answer_file(json)
    if junit is not None and check is None:
        raise UsageError("--junit needs --check: without tolerances there is nothing that passes or fails")
    for option, file in (("--summary", summary), ("--junit", junit)):
        if file is not None:
            check_place(file, option)
    if output is not None:
        check_place(output, "--output", folder=True)
    reference = "published" if against is None or against in AGAINST else "baseline"
    tolerances = None if check is None else read_tolerances(check, reference)
    logs = None if repetition is None else of_repetition(path, repetition)
    target = output or (None if repetition is None else own_folder(path / f"repetition_{repetition}"))
    made = build_report(path, against=against, output=target, logs=logs, further=further_pictures, template=template)
    console = make_console()
    print_report(console, made)
    violations = None if tolerances is None else check_cells(made.comparison, tolerances, made.differs)
    if summary is not None:
        sheets = [*made.sheets, made.conditions]
        replace_file(summary, summary_markdown(made.title, made.verdict, sheets, violations))
    write_answer(json, report_answer(made, against, violations))
    if tolerances is not None and violations is not None:
        if junit is not None:
            replace_file(junit, junit_xml("hjcamp", made.comparison, violations, list(tolerances)))
        if violations:
            more = f"\n  ... and {len(violations) - SHOWN} more" if len(violations) > SHOWN else ""
            lines = "\n  ".join(map(str, violations[:SHOWN]))
            raise HjcampError(f"{counted(len(violations), 'mean is', 'means are')} outside the tolerances\n  {lines}{more}")
        console.print("  check   every mean is within the tolerances")


def print_report(console: Console, made: Report) -> None:
    """Print the tables of a report, how far its means are from what they are compared with, and where the page is."""
    from hjcamp.campaign.execution.console import bold
    from hjcamp.report.tables.factors import MOST_ROWS, effects_sheet
    from hjcamp.report.tables.terminal import FittedSheet

    console.print(FittedSheet(made.conditions))
    for sheet in made.sheets:
        console.print(bold(sheet.title, before="\n"))
        console.print(FittedSheet(sheet))
    if (found := effects_sheet(made.effects, MOST_ROWS)) is not None:
        console.print(bold(found.title, before="\n"))
        console.print(FittedSheet(found))
    if made.verdict:
        console.print(f"  {made.verdict}", markup=False)
    console.print(f"  report  {made.page}", markup=False, soft_wrap=True)


def of_repetition(path: Path, repetition: int) -> list[TestLog]:
    """Return the logs of one repetition; ``UsageError`` with those that are there for one that is not."""
    from hjcamp.records.stored import stored_logs

    logs = stored_logs([path])
    found = [log for log in logs if log.metadata.get("repetition") == str(repetition)]
    if logs and not found:
        there = sorted({log.metadata.get("repetition") or "none" for log in logs}, key=lambda one: (len(one), one))
        raise UsageError(f"--repetition {repetition}: no log in {path} is of it; there are {', '.join(there)}")
    return found
