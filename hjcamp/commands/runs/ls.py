"""List runs, newest first; filter them with KEY=VALUE (campaign, state, payload, git, any parameter)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError
from hjcamp.storage import check_place, shown_path


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("ls")(ls)


def ls(
    filters: Annotated[
        list[str] | None, typer.Argument(metavar="[FOLDER] [KEY=VALUE]", help="Folders to look in, and what runs must hold.")
    ] = None,
    folder: Annotated[Path | None, typer.Option(help="Where to look; runs and multirun by default.")] = None,
    columns: Annotated[
        str | None,
        typer.Option(help="What to show, with commas: payload,controller.positive.kp,rmse1_deg,git; +NAME adds."),
    ] = None,
    sort: Annotated[str | None, typer.Option(help="The column to sort by; -COLUMN from the largest.")] = None,
    page: Annotated[
        Path | None, typer.Option(help="Write a page of these runs, such as runs/index.html, with links to reports.")
    ] = None,
    json: AnswerFile = None,
) -> None:
    """List runs, newest first; filter them with KEY=VALUE (campaign, state, payload, git, any parameter)."""
    from rich.table import Table

    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.runs.finding import FOLDERS, find_runs
    from hjcamp.campaign.runs.listing import USUAL, in_order, rows_of

    if folder is not None and not folder.is_dir():
        raise UsageError(f"--folder {shown_path(folder)}: there is no such folder")
    named = [Path(text) for text in filters or [] if "=" not in text and Path(text).is_dir()]
    wanted = [text for text in filters or [] if Path(text) not in named]
    folders = list(dict.fromkeys([*named, *([folder] if folder else [])]))
    runs = find_runs(folders or FOLDERS, wanted)
    names = [name.strip() for name in (columns or "").split(",") if name.strip()]
    if columns is not None and not names:
        raise UsageError("--columns: name at least one column, such as  --columns run,payload,rmse1_deg")
    added = [name.removeprefix("+") for name in names]
    shown = list(dict.fromkeys([*USUAL, *added] if not names or any(one.startswith("+") for one in names) else ["run", *added]))
    check_answer_file(json)
    if page is not None:
        check_place(page, "--page")
    rows = rows_of(runs, shown)
    rows = in_order(rows, sort) if sort is not None else rows
    write_answer(json, {"schema": "hjcamp.runs/1", "columns": shown, "runs": rows})
    if page is not None:
        from hjcamp.report.pages.runs_page import runs_page
        from hjcamp.report.tables.store import replace_file

        there = [run.path for run in runs if (run.path / "report.html").is_file()]
        links = {str(path): _link(path / "report.html", page) for path in there}
        replace_file(page, runs_page(shown, rows, links))
    console = make_console()
    if page is not None:
        console.print(f"page    {page}", markup=False, soft_wrap=True)
    if not runs:
        console.print("no runs found" + (" that meet the filters" if filters else "; the first: hjcamp run campaign=NAME"))
        return
    table = Table(box=None, header_style="bold")
    for name in shown:
        table.add_column(name, no_wrap=name != "run", overflow="fold")
    for row in rows:
        table.add_row(*[_cell(row[name]) for name in shown])
    console.print(table)


def _link(path: Path, page: Path) -> str:
    from urllib.parse import quote

    return quote(Path(os.path.relpath(path.resolve(), page.resolve().parent)).as_posix())


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
