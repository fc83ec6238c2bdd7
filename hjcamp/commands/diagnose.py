"""Say which physical effect the model misses, or that nothing is missing, or that these tests cannot tell."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.errors import UsageError, unknown

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.discrepancy.diagnose import Diagnosis

HEADLINES = {
    "nothing_missing": ("NOTHING MISSING", "green"),
    "effect": ("EFFECT", "bold"),
    "one_of": ("ONE OF", "yellow"),
    "outside_library": ("OUTSIDE LIBRARY", "yellow"),
    "cannot_tell": ("CANNOT TELL", "yellow"),
}
SHOWN = 6


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("diagnose")(diagnose)


def diagnose(
    paths: Annotated[list[Path], typer.Argument(help="Run folders, folders of logs, or log files.")],
    model: Annotated[str, typer.Option(help="The model to start from.")] = "published",
    json: Annotated[Path | None, typer.Option(help="Write the answer for programs to this file.")] = None,
    effort: Annotated[str, typer.Option(help="quick, standard or thorough.")] = "standard",
    seed: Annotated[int, typer.Option(help="Seed of the simulated twins.")] = 1,
    workers: Annotated[int | None, typer.Option(help="Threads; every processor by default. The answer is the same.")] = None,
    cluster: Annotated[str | None, typer.Option(help="A dask scheduler, tcp://HOST:PORT, or 'local'.")] = None,
) -> None:
    """Say which physical effect the model misses, or that nothing is missing, or that these tests cannot tell."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._session import check_answer_file, evidence_of, folder_for, progress_of, write_answer

    began = time.perf_counter()
    check_answer_file(json)
    if seed < 0:
        raise UsageError(f"--seed {seed}: give a whole number, 0 or more")
    if workers is not None and workers < 1:
        raise UsageError(f"--workers {workers}: give a whole number, 1 or more")
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.discrepancy.answer import answer
        from hjcamp.discrepancy.crew import Crew, available
        from hjcamp.discrepancy.diagnose import EFFORTS
        from hjcamp.discrepancy.diagnose import diagnose as search
        from hjcamp.discrepancy.saved import saved_model
        from hjcamp.effects import load_effects

        if effort not in EFFORTS:
            raise unknown("effort", effort, EFFORTS)
        start = saved_model(model)
        effects = tuple(load_effects().values())
        evidence = evidence_of(paths)
        crew = Crew(workers or available(), cluster)
        try:
            begin = start if start.base or start.effects else None
            found = search(evidence, effects, effort=effort, seed=seed, start=begin, crew=crew, report=report)
            content = answer(found, effects, effort, 0.0, report)
        finally:
            crew.close()
        content["seconds"] = round(time.perf_counter() - began, 3)
        write_answer(json, content)
        page = _draw(content, found.reason, folder_for("diagnose", paths, json))
    _print(console, found, content, paths, len(effects))
    console.print(f"page    {page}", markup=False)
    console.print(f"next    {next_command(content, paths)}", markup=False)


def next_command(content: dict[str, Any], paths: list[Path]) -> str:
    """Return the command that goes on from an answer."""
    from hjcamp.commands import command_files
    from hjcamp.commands._session import joined

    verdict = content["verdict"]
    if verdict == "effect":
        return f"hjcamp add {' '.join(content['effects'])} {joined(paths)} --as NEW"
    if verdict == "outside_library":
        return "hjcamp effects new NAME   (write the effect, then diagnose again)"
    if verdict == "nothing_missing":
        return f"hjcamp compare {joined(paths)}"
    return f"hjcamp next {joined(paths)}" if "next" in command_files() else f"hjcamp compare {joined(paths)}"


def _print(console: Console, found: Diagnosis, content: dict[str, Any], paths: list[Path], library: int) -> None:
    moved = [
        f"{name} {row['published']:.4g} -> {row['value']:.4g} {row['unit']}"
        for name, row in content["calibration"].items()
        if abs(row["value"] - row["published"]) > 0.01 * abs(row["published"])
    ]
    console.print(f"calibrated first   {', '.join(moved) or 'nothing moved'}", markup=False)
    fitted = len({name for step in found.steps for name in step.fits})
    twins = len(found.null.gains)
    count = f"screened {library} effects, fitted {fitted}, {twins} twins with nothing missing"
    console.print(f"{count}   {content['seconds']:.0f} s", markup=False)
    if found.exploratory:
        console.print("exploratory: no test was repeated, so the scatter of the rig is assumed", style="yellow")
    title, style = HEADLINES[content["verdict"]]
    console.print(f"{title}   {_sentence(found, content)}", style=style, markup=False)
    _candidates(console, content)
    error = content["error"]
    if error["baseline"] is not None:
        said = f"{error['baseline']:.2f} -> {error['augmented']:.2f} x floor"
        console.print(f"        error on tests not used for the fit   {said}", markup=False)


def _sentence(found: Diagnosis, content: dict[str, Any]) -> str:
    verdict = content["verdict"]
    chance = f"p = {content['p_value']:.2f} against twins"
    if verdict == "effect":
        return f"{' and '.join(content['effects'])}   ({chance})"
    if verdict == "one_of":
        return f"{', '.join(content['effects'])}: {found.reason}   ({chance})"
    if verdict == "outside_library":
        drivers = ", then ".join(one.replace("_", " ") for one in content["drivers"][:2]) or "nothing that was measured"
        return f"{found.reason}. What is left depends on {drivers}."
    if verdict == "nothing_missing":
        least = content["minimum_detectable"]
        shown = ", ".join(f"{name} {row['value']:.2g} {row['unit']}" for name, row in list(least.items())[:SHOWN])
        return f"these tests would have shown {shown}   ({chance})"
    return found.reason


def _candidates(console: Console, content: dict[str, Any]) -> None:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("", "effect", "posterior", "held-out error", "parameters (95 %)"):
        table.add_column(heading, justify="right" if heading in ("posterior", "held-out error") else "left")
    for number, row in enumerate(content["candidates"][:SHOWN], start=1):
        told = ", ".join(
            f"{name} {one['value']:.3g} {one['unit']} [{one['ci95'][0]:.3g}, {one['ci95'][1]:.3g}]"
            for name, one in row["parameters"].items()
        )
        ratio = row["heldout_error_ratio"]
        share = "" if ratio is None else f"{100 * (ratio - 1):+.0f} %"
        posterior = "<0.01" if row["posterior"] < 0.005 else f"{row['posterior']:.2f}"
        table.add_row(f"  {number}", row["effect"], posterior, share, told.replace("[", "\\["))
    if content["candidates"]:
        console.print(table)


def _draw(content: dict[str, Any], reason: str, folder: Path) -> Path:
    """Write the picture of the errors and the page; return the page."""
    from hjcamp.records.write import whole_file
    from hjcamp.report.discrepancy_figures import draw_errors
    from hjcamp.report.discrepancy_page import discrepancy_page

    error = content["error"]
    rows = [(name, error[name]) for name in ("baseline", "augmented", "floor") if error[name] is not None]
    svg = draw_errors(rows)
    with whole_file(folder / "errors.svg") as stream:
        stream.write(svg.encode())
    table = [
        [row["effect"], f"{row['posterior']:.2f}", *_value_cells(name, one)]
        for row in content["candidates"]
        for name, one in row["parameters"].items()
    ]
    table += [["base", "", *_value_cells(name, one)] for name, one in content["calibration"].items()]
    named = ", ".join(content["effects"] or content["drivers"][:3])
    title = HEADLINES[content["verdict"]][0].capitalize() + (f": {named}" if named else "")
    headings = ("effect", "posterior", "parameter", "value", "95 %")
    page = folder / "index.html"
    pictures = [("Error on tests not used for the fit", svg)]
    with whole_file(page) as stream:
        stream.write(discrepancy_page(title, [reason], headings, table, content["where"], pictures).encode())
    return page


def _value_cells(name: str, row: dict[str, Any]) -> list[str]:
    low, high = row["ci95"]
    return [name, f"{row['value']:.4g} {row['unit']}", f"{low:.4g} to {high:.4g}"]
