"""Show one run: its state, what it varies, its failures, its tables and where they are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer

if TYPE_CHECKING:
    from rich.console import Console

SHOWN = 10


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("show")(show)


def show(run: Annotated[Path, typer.Argument(help="The run folder.")], json: AnswerFile = None) -> None:
    """Show one run: its state, what it varies, its failures, its tables and where they are."""
    from hjcamp.campaign.execution.console import bold, make_console
    from hjcamp.campaign.files.run_folder import open_folder
    from hjcamp.campaign.runs.finding import FoundRun
    from hjcamp.commands.campaigns.plan import common_choices
    from hjcamp.commands.shared.answers import run_answer

    check_answer_file(json)
    folder = open_folder(run)
    found = FoundRun(run, folder.plan, folder.manifest)
    write_answer(json, run_answer(found))
    console = make_console()
    console.print(bold(str(run), f"   {folder.plan.campaign}, {found.state}, {found.done} of {len(folder.plan.tests)} tests"))
    console.print(f"  {common_choices(folder.plan)}", markup=False)
    for name, labels in folder.plan.axes.items():
        console.print(f"  {name}: {' '.join(labels)}", markup=False)
    for session in folder.manifest["sessions"]:
        commit = str(session.get("git") or "no git")[:12] + ("+changes" if session.get("git_changes_sha256") else "")
        ended = session.get("ended_at") or "not ended"
        console.print(f"  {session['started_at']} to {ended}, {session.get('host')}, hjcamp {session['version']}, {commit}")
    failed = [(name, entry) for name, entry in folder.manifest["tests"].items() if entry["state"] == "failed"]
    for name, entry in failed[:SHOWN]:
        console.print(f"  failed  {name}: {entry.get('message')}", style="red", markup=False)
    if len(failed) > SHOWN:
        console.print(f"  ... and {len(failed) - SHOWN} more in {run / 'manifest.json'}", style="red")
    _tables(run, console)
    if found.done < len(folder.plan.tests):
        console.print(f"  next    hjcamp resume {run}")


def _tables(run: Path, console: Console) -> None:
    from rich.markdown import Markdown

    files = sorted((run / "tables").glob("*.md"))
    for file in files:
        console.print(Markdown(file.read_text(encoding="utf-8")), soft_wrap=False)
    if files:
        console.print(f"  tables  {run / 'tables'}", markup=False)
    if (run / "report.html").is_file():
        console.print(f"  report  {run / 'report.html'}", markup=False)
