"""Two runs side by side: what is set differently, and which means differ by more than scatter."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer

if TYPE_CHECKING:
    from rich.console import Console

NAMED = 3


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("diff")(diff)


def diff(
    run: Annotated[Path, typer.Argument(metavar="A", help="A run folder or a folder of logs.")],
    other: Annotated[Path, typer.Argument(metavar="B", help="Another one.")],
    all_rows: Annotated[bool, typer.Option("--all", help="Also the means that do not differ.")] = False,
    json: AnswerFile = None,
) -> None:
    """Two runs side by side: what is set differently, and which means differ by more than scatter.

    Means of the same condition are compared by Welch's t test, with Holm's correction for the number of comparisons.
    """
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.report.run_difference import run_difference

    check_answer_file(json)
    found = run_difference(run, other)
    write_answer(json, found)
    console = make_console()
    for letter, name in zip("AB", found["runs"], strict=True):
        console.print(f"  {letter}  {name}", markup=False, soft_wrap=True)
    _print_settings(console, found)
    _print_results(console, found, all_rows)


def _print_settings(console: Console, found: dict[str, Any]) -> None:
    from rich.table import Table

    rows = [(one["name"], *map(" ".join, one["values"]), "") for one in found["origin"]]
    pairs = len(found["pairs"] or found["alone"][0])
    for one in found["configuration"]:
        rows.append((one["parameter"], *_shown(one), _conditions(one["conditions"], pairs)))
    if rows:
        table = Table(box=None, header_style="bold", pad_edge=False)
        for heading in ("setting", "A", "B", "in"):
            table.add_column(heading, no_wrap=heading == "setting", overflow="fold")
        for row in rows:
            table.add_row(*[str(cell) for cell in row])
        console.print(table)
    else:
        console.print("  nothing is set differently", markup=False)
    for place, alone in enumerate(found["alone"]):
        if alone:
            console.print(f"  only in {found['runs'][place]}: {_conditions(alone, 0)}", markup=False, soft_wrap=True)


def _print_results(console: Console, found: dict[str, Any], all_rows: bool) -> None:
    from rich.table import Table

    from hjcamp.report.tables.sheet import TITLES, with_deviation
    from hjcamp.report.tables.welch import SIGNIFICANT

    if not found["pairs"]:
        console.print("  no condition is in both, so no means are compared", markup=False)
        return
    judged = [(row, row["p_holm"] is None or row["p_holm"] < SIGNIFICANT) for row in found["results"]]
    rows = [row for row, differs in judged if differs or all_rows]
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("condition", "deg", "A", "B", "difference", "p"):
        table.add_column(heading, justify="left" if heading in ("condition", "deg") else "right", overflow="fold")
    for row in rows:
        table.add_row(
            row["condition"],
            TITLES[row["indicator"]],
            with_deviation(row["mean"], row["std"], 3),
            with_deviation(row["baseline_mean"], row["baseline_std"], 3),
            f"{row['difference']:+.3f}",
            "–" if row["p_holm"] is None else f"{row['p_holm']:.2g}",
        )
    if rows:
        console.print()
        console.print(table)
    more = "" if len(rows) == len(judged) else f" {len(judged) - len(rows)} that do not are left out; --all shows them."
    console.print(f"  {found['verdict']}{more}", markup=False)


def _shown(row: dict[str, Any]) -> list[str]:
    texts = ["none" if value is None else f"{value:g}" if isinstance(value, float) else str(value) for value in row["values"]]
    return ["absent" if place in row["absent_in"] else text for place, text in enumerate(texts)]


def _conditions(names: list[str], pairs: int) -> str:
    if len(names) == pairs:
        return "all" if pairs > 1 else ""
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return f"{', '.join(names[:NAMED])}{more}"
