"""An indicator of a campaign over commits or runs: a table, a figure, and where it changed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, check_picture, write_answer
from hjcamp.errors import UsageError, counted
from hjcamp.storage import shown_path

if TYPE_CHECKING:
    from rich.table import Table


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("history")(history)


def history(
    words: Annotated[
        list[str],
        typer.Argument(metavar="campaign=NAME [KEY=VALUE...] [INDICATOR]", help="The runs, filtered as by ls; rmse1_deg."),
    ],
    over: Annotated[str, typer.Option(help="commits (the newest run of each) or runs.")] = "commits",
    folder: Annotated[Path | None, typer.Option(help="Where to look; runs and multirun by default.")] = None,
    figure: Annotated[Path | None, typer.Option(help="Draw it into this file (png, svg, pdf).")] = None,
    json: AnswerFile = None,
) -> None:
    """An indicator of a campaign over commits or runs: a table, a figure, and where it changed.

    A row tells the mean over the conditions that all rows share, and how many of them differ from the row before
    (Welch's t test with Holm's correction, p < 0.05).
    """
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.runs.finding import FOLDERS, find_runs
    from hjcamp.campaign.runs.history import history_rows, moments_of, read_words
    from hjcamp.report.pictures.history import draw_history

    if folder is not None and not folder.is_dir():
        raise UsageError(f"--folder {shown_path(folder)}: there is no such folder")
    filters, indicator = read_words(words)
    if figure is not None:
        check_picture(figure)
    check_answer_file(json)
    runs = find_runs([folder] if folder else FOLDERS, filters)
    if not runs:
        raise UsageError(f"no run meets {' '.join(filters)}; see: hjcamp ls")
    moments, without = moments_of(runs, indicator, over)
    shared, rows = history_rows(moments)
    answer = {"schema": "hjcamp.history/1", "indicator": indicator, "over": over, "conditions": shared, "rows": rows}
    write_answer(json, {**answer, "without_report": without})
    console = make_console()
    console.print(table_of(rows, indicator))
    said = f"deg, mean over {counted(len(shared), 'condition')} ± its standard error"
    console.print(
        f"  {said}; changed: conditions that differ from the row before, the largest named", style="dim", markup=False
    )
    if without:
        none = counted(len(without), "run has", "runs have")
        console.print(f"  {none} no report: {', '.join(without[:3])}", markup=False, soft_wrap=True)
    labels = [row["commit"] if over == "commits" and row["commit"] else row["started"][:16] for row in rows]
    title = " ".join(filters)
    if figure is not None:
        draw_history(figure, f"{title}: {indicator}", indicator, rows, labels)
        console.print(f"  picture  {figure}", markup=False, soft_wrap=True)


def table_of(rows: Sequence[Mapping[str, Any]], indicator: str) -> Table:
    """Return the table of a history: a row for each run or commit, with the condition that differs most from the row before."""
    from rich.table import Table

    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("commit", "started", "tests", indicator, "changed", "run"):
        table.add_column(heading, justify="right" if heading in ("tests", indicator) else "left", overflow="fold")
    for row in rows:
        error = "" if row["standard_error"] is None else f" ± {row['standard_error']:.3f}"
        first = max(row["changed"], key=lambda one: abs(one["difference"]), default=None)
        changed = f"{len(row['changed'])}: {first['condition']} {first['difference']:+.3f}" if first else ""
        cells = (
            row["commit"] or row["version"],
            row["started"],
            str(row["tests"]),
            f"{row['mean']:.3f}{error}",
            changed,
            row["run"],
        )
        table.add_row(*cells)
    return table
