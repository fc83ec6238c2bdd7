"""Write what a text needs of runs and answers: tables, figures, numbers as macros, BibTeX."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError, counted
from hjcamp.storage import check_place, shown_path


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("paper")(paper)


def paper(
    paths: Annotated[
        list[Path],
        typer.Argument(metavar="RUN...", help="Runs, folders of logs, and answers of compare, diagnose, calibrate (.json)."),
    ],
    folder: Annotated[Path, typer.Option("--as", metavar="DIR", help="The folder to write; main.tex there is kept.")],
    style: Annotated[str, typer.Option(help="plain, ieee, elsevier, springer or thesis.")] = "plain",
    width: Annotated[float | None, typer.Option(help="Width of the figures, mm; the style's by default.")] = None,
    formats: Annotated[
        str | None, typer.Option(help="pdf,svg,pgf; by default all that can be made: pgf needs pdflatex.")
    ] = None,
    only: Annotated[
        str | None, typer.Option(help="Figures wanted, with commas: means, or names of conditions; all by default.")
    ] = None,
    json: AnswerFile = None,
) -> None:
    """Write what a text needs of runs and answers: tables, figures, numbers as macros, BibTeX.

    DIR gets tables/*.tex (siunitx, booktabs), figures/, numbers.tex, references.bib (the sources in the docstrings of the
    effects in use) and, once, a main.tex that shows them all. A macro such as RampPosPidRmseOne holds a mean with its
    standard uncertainty, s over the root of n; ...Std the deviation of the tests, ...N their number.
    """
    from hjcamp.campaign.execution.console import bold, make_console
    from hjcamp.report.paper.figures import formats_of, style_of
    from hjcamp.report.paper.folder import write_paper

    chosen, kinds = style_of(style, width), formats_of(formats)
    check_answer_file(json)
    check_place(folder, "--as", folder=True)
    for path in paths:
        if not path.exists():
            raise UsageError(f"{shown_path(path)}: there is no such run, folder or answer; see: hjcamp ls")
    wanted = [name.strip() for name in (only or "").split(",") if name.strip()]
    made = write_paper(paths, folder, chosen, kinds, documented, wanted)
    numbers = {
        name: {"value": one.value, "uncertainty": one.uncertainty, "unit": one.unit} for name, one in made.numbers.items()
    }
    write_answer(
        json,
        {
            "schema": "hjcamp.paper/1", "runs": [str(path) for path in paths], "folder": str(folder), "tables": made.tables,
            "figures": made.figures, "captions": made.captions, "numbers": numbers, "cite": made.cite,
        },
    )  # fmt: skip
    console = make_console()
    console.print(
        bold(
            str(folder),
            f"   {counted(len(made.tables), 'table')}, {counted(len(made.figures), 'figure')}, "
            f"{counted(len(numbers), 'number')}, {counted(len(made.cite), 'source')}",
        )
    )
    if numbers:
        name, one = next((item for item in made.numbers.items() if item[1].uncertainty), next(iter(made.numbers.items())))
        console.print(f"  such as \\{name} = {one.latex}", markup=False, soft_wrap=True)
    console.print(f"  cite    {' '.join(made.cite) or 'nothing'}", markup=False, soft_wrap=True)
    console.print(f"  next    cd {folder} && pdflatex main && bibtex main && pdflatex main", markup=False, soft_wrap=True)


def documented(plant: str, names: set[str]) -> Sequence[object]:
    """Return the effects of these names on a plant ('': the usual one), whose docstrings tell their sources."""
    from hjcamp.effects import library_of
    from hjcamp.known_plants import DEFAULT

    library = library_of(plant or DEFAULT)
    return [library.effects[name] for name in sorted(names) if name in library.effects]
