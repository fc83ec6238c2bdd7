"""Look at, check, recover, export and view test logs: hjcamp log info, verify, recover, export, view."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands import PLAIN
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import HjcampError, counted, visible
from hjcamp.storage import check_place, keep_within, own_folder

EXPORT, VIEW = Path("export"), Path("view")
Paths = Annotated[list[Path], typer.Argument(help="Run folders, folders of logs, or log files.")]


def register(app: typer.Typer) -> None:
    """Add the commands."""
    group = typer.Typer(
        name="log",
        help="Look at, check, recover, export and view test logs.",
        no_args_is_help=True,
        **PLAIN,
    )
    group.command("info")(info)
    group.command("verify")(verify)
    group.command("recover")(recover)
    group.command("export")(export)
    group.command("view")(view)
    app.add_typer(group)


def info(paths: Paths, json: AnswerFile = None) -> None:
    """Show what logs hold: samples, duration, fields, metadata."""
    from hjcamp.commands.shared.answers import log_rows
    from hjcamp.records.find import find_logs
    from hjcamp.records.of_plant import span
    from hjcamp.records.recover import verify_log

    check_answer_file(json)
    rows = []
    for path in find_logs(paths):
        found = verify_log(path)
        rows.append(found)
        print(f"{path}: {counted(found.samples, 'sample')}, {found.duration:.3f} s, {'whole' if found.whole else 'NOT WHOLE'}")
        for problem in () if found.whole else found.problems[:1]:
            print(visible(f"  problem      {problem}"))
        print(f"  of           plant {found.plant}, one sample each {span(found.period)}")
        print(visible(f"  fields       {' '.join(found.fields)}"))
        print(visible(f"  attachments  {' '.join(found.attachments) or 'none'}"))
        for name, value in found.metadata.items():
            print(visible(f"  {name:<12} {value}"))
    write_answer(json, {"schema": "hjcamp.logs/1", "logs": log_rows(rows)})


def verify(paths: Paths, json: AnswerFile = None) -> None:
    """Check that logs are whole, meet the contract and are plausible, each and as a set; exit code 1 where one is not."""
    from hjcamp.commands.shared.answers import log_rows
    from hjcamp.known_plants import DEFAULT
    from hjcamp.records.find import find_logs
    from hjcamp.records.of_plant import span
    from hjcamp.records.recover import verify_logs

    check_answer_file(json)
    damaged, implausible, doubtful = 0, 0, 0
    kinds: Counter[tuple[str, float, tuple[str, ...]]] = Counter()
    logs = find_logs(paths)
    rows = verify_logs(logs)
    for path, found in zip(logs, rows, strict=True):
        damaged += not found.whole
        if found.whole and found.plant != DEFAULT:
            kinds[found.plant, found.period, found.fields] += 1
        implausible += found.refused
        doubtful += bool(found.findings) and not found.refused
        for problem in [*found.problems, *(one.line for one in found.findings)]:
            print(visible(f"{path}: {problem}"))
    for (plant, period, fields), number in kinds.items():
        print(f"{counted(number, 'log')} of plant {plant}, one sample each {span(period)}: {' '.join(fields)}")
    whole = f"{counted(len(logs), 'log')}, {len(logs) - damaged} whole, {damaged} not"
    print(f"{whole}; {implausible} with what cannot be, {doubtful} with warnings" if implausible + doubtful else whole)
    write_answer(json, {"schema": "hjcamp.logs/1", "logs": log_rows(rows)})
    if damaged:
        raise HjcampError(f"{damaged} of {counted(len(logs), 'log')} not whole; try: hjcamp log recover PATH")
    if implausible:
        raise HjcampError(
            f"what cannot be is in {implausible} of {counted(len(logs), 'log')}; "
            "import them again with the right units, or leave them out"
        )


def recover(
    path: Annotated[Path, typer.Argument(help="A damaged log or a .part file.")],
    output: Annotated[Path | None, typer.Option(help="The new log; NAME.recovered.mcap by default.")] = None,
    json: AnswerFile = None,
) -> None:
    """Write what is whole in a damaged log to a new one."""
    from hjcamp.records.recover import recover_log

    if output is not None:
        check_place(output, "--output")
    check_answer_file(json)
    keep_within(path.parent)
    stem = path.name.removesuffix(".part").removesuffix(".mcap")
    result = recover_log(path, output or path.with_name(f"{stem}.recovered.mcap"))
    for problem in result.problems:
        print(visible(f"  {problem}"))
    print(f"{result.path}: {result.words}")
    answer = {"schema": "hjcamp.recovery/1", "log": str(result.path), "kept": result.kept, "lost": result.lost}
    write_answer(json, {**answer, "lost_is_exact": result.lost_is_exact, "problems": list(result.problems)})


def export(
    paths: Paths,
    kind: Annotated[str, typer.Option("--as", help="parquet, csv, mat or npz.")] = "parquet",
    into: Annotated[Path, typer.Option(help="The folder of the tables.")] = EXPORT,
    json: AnswerFile = None,
) -> None:
    """Write logs as tables for other programs, one file each, with units and metadata."""
    from hjcamp.records.find import find_logs
    from hjcamp.records.read import read_log
    from hjcamp.records.views.exporting import export_logs

    check_answer_file(json)
    written = export_logs(find_logs(paths), read_log, kind, own_folder(into) if into == EXPORT else into)
    write_answer(json, {"schema": "hjcamp.export/1", "files": [str(path) for path in written]})
    for path in written:
        print(path)


def view(
    paths: Paths,
    viewer: Annotated[str, typer.Option("--with", help="foxglove, plotjuggler or rerun.")] = "rerun",
    into: Annotated[Path, typer.Option(help="The folder of layouts and recordings.")] = VIEW,
    begin: Annotated[bool, typer.Option("--open/--no-open", help="Begin the viewer where it is installed.")] = True,
    json: AnswerFile = None,
) -> None:
    """Show logs in a viewer with a layout of their plant: curves by panel, phases as states or events."""
    import shlex

    from hjcamp.commands.shared.view import begin_viewer, prepare_view
    from hjcamp.records.find import find_logs

    check_answer_file(json)
    made = prepare_view(list(find_logs(paths)), viewer, own_folder(into) if into == VIEW else into)
    files = [str(path) for path in made.files]
    answer = {"schema": "hjcamp.view/1", "viewer": viewer, "files": files, "command": list(made.command)}
    write_answer(json, {**answer, "installed": made.installed})
    for path in files:
        print(path)
    if made.advice:
        print(made.advice)
    if made.installed and begin:
        begin_viewer(made)
    else:
        missing = "" if made.installed else f"{viewer} is not installed here; where it is: "
        print(f"{missing}{shlex.join(made.command)}")
