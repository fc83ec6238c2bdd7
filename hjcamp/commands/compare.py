"""Replay measured tests with one or more models: the error, its floor, and where it comes from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.discrepancy.compare import Compared

ROWS = (
    ("arm_deg", "arm angle", 1.0, "deg"),
    ("pressure1_mpa", "line 1", 1e3, "kPa"),
    ("pressure2_mpa", "line 2", 1e3, "kPa"),
    ("pump_deg", "pump", 1.0, "deg"),
)
BAR = 30


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("compare")(compare)


def compare(
    paths: Annotated[list[Path], typer.Argument(help="Run folders, folders of logs, or log files.")],
    model: Annotated[list[str] | None, typer.Option(help="A saved model; may be repeated.")] = None,
    json: Annotated[Path | None, typer.Option(help="Write the answer for programs to this file.")] = None,
) -> None:
    """Replay measured tests with one or more models: the error, its floor, and where it comes from."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._session import check_answer_file, evidence_of, folder_for, progress_of, write_answer

    names = model or ["published"]
    if len(set(names)) < len(names):
        raise UsageError(f"--model {' --model '.join(names)}: each model once")
    check_answer_file(json)
    console = make_console()
    with progress_of(console) as report:
        from hjcamp.discrepancy.compare import answer
        from hjcamp.discrepancy.compare import compare as compare_models
        from hjcamp.discrepancy.saved import saved_model
        from hjcamp.effects import load_effects

        models = {name: saved_model(name) for name in names}
        evidence = evidence_of(paths)
        report(f"replaying {len(evidence.tests)} tests", 0.2)
        compared = compare_models(evidence, tuple(load_effects().values()), models)
        write_answer(json, answer(compared, len(evidence.tests)))
        report("drawing", 0.7)
        files = _draw(compared, folder_for("compare", paths, json))
    _print(console, compared, paths, files)


def _print(console: Console, compared: list[Compared], paths: list[Path], files: list[Path]) -> None:
    from hjcamp.commands._session import joined
    from hjcamp.discrepancy.where import sentences

    evidence = compared[0].replay.evidence
    count = f"{len(evidence.tests)} tests, {len(evidence.conditions)} conditions"
    console.print(f"{count}, replay driven by the measured pump")
    if not evidence.repeated:
        console.print("  exploratory: no test was repeated, so there is no floor to compare with", style="yellow")
    for one in compared:
        console.print(f"[bold]{one.replay.name}[/bold]", highlight=False)
        _table(console, one)
    if len(compared) > 1:
        _bars(console, compared)
    last = compared[-1]
    lines = sentences(last.places)
    label = f"where    ({last.replay.name}) " if len(compared) > 1 else "where    "
    console.print(label + lines[0], markup=False)
    for line in lines[1:]:
        console.print(f"         {line}", markup=False)
    if last.horizon.born:
        early, late = (1e3 * one for one in last.horizon.born)
        console.print(f"         error against horizon: born between {early:.0f} and {late:.0f} ms after a restart")
    console.print(f"figures  {'  '.join(str(file) for file in files[:-1])}", markup=False)
    console.print(f"page     {files[-1]}", markup=False)
    console.print(f"next     hjcamp diagnose {joined(paths)}", markup=False)


def _table(console: Console, one: Compared) -> None:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("               ", no_wrap=True)
    for heading in ("error", "floor", "error / floor", "r2"):
        table.add_column(heading, justify="right")
    for name, text, scale, unit in ROWS:
        error = one.replay.errors[name]
        if error is None:
            table.add_row(f"  {text}", "not logged", "", "", "")
            continue
        floor = "none" if error.floor is None else f"{error.floor * scale:.3g} {unit}"
        over = "" if error.ratio is None else f"{error.ratio:.1f}"
        fraction = "" if error.r2 is None else f"{error.r2:.3f}"
        table.add_row(f"  {text}", f"{error.rms * scale:.3g} {unit}", floor, over, fraction)
    console.print(table)


def _bars(console: Console, compared: list[Compared]) -> None:
    longest = max(one.score for one in compared)
    width = max(len(one.replay.name) for one in compared)
    console.print("error / floor, geometric mean of arm and lines")
    for one in compared:
        bar = "█" * max(1, round(BAR * one.score / longest))
        console.print(f"  {one.replay.name:<{width}}  {bar} {one.score:.2f}", markup=False)
    if compared[0].replay.evidence.repeated:
        console.print(f"  {'floor':<{width}}  {'█' * max(1, round(BAR / longest))} 1.00", markup=False)


def _draw(compared: list[Compared], folder: Path) -> list[Path]:
    """Write overlay, where, horizon and the page that holds them; return their paths."""
    import numpy as np

    from hjcamp.discrepancy.where import SLIDING, sentences
    from hjcamp.records.write import whole_file
    from hjcamp.report.discrepancy_figures import HorizonCurve, Overlay, draw_horizon, draw_map, draw_overlay
    from hjcamp.report.discrepancy_page import discrepancy_page

    evidence, last = compared[0].replay.evidence, compared[-1]
    worst, excess = 0, -1.0
    overlays = []
    for name, tests in evidence.conditions.items():
        index = tests[0]
        part = slice(int(evidence.edges[index]), int(evidence.edges[index + 1]))
        models = {one.replay.name: one.replay.predicted[part] for one in compared}
        overlays.append(Overlay(name, evidence.tests[index].time, last.replay.measured[part], models))
        error = float(np.sqrt(np.mean((last.replay.predicted[part, 0] - last.replay.measured[part, 0]) ** 2)))
        if error > excess:
            worst, excess = len(overlays) - 1, error
    slides = evidence.sliding
    velocity, arm = evidence.joined("velocity")[slides] * 1e3, last.replay.measured[slides, 0]
    curves = [HorizonCurve(one.replay.name, one.horizon.time, one.horizon.rms, one.horizon.floor) for one in compared]
    pictures = {
        "overlay": draw_overlay(overlays[worst]),
        "where": draw_map(velocity, arm, last.residuals[slides, SLIDING], [p.row() for p in last.places]),
        "horizon": draw_horizon(curves),
    }
    files = [folder / f"{name}.svg" for name in pictures]
    for file, svg in zip(files, pictures.values(), strict=True):
        with whole_file(file) as stream:
            stream.write(svg.encode())
    captions = {
        "overlay": f"Overlay: {overlays[worst].name}, the condition with the largest error of the arm",
        "where": "Where: force that the balance of the sliding arm lacks, over speed and angle",
        "horizon": "Error of the arm against the time since a restart from measured states",
    }
    rows = [p.row() for p in last.places]
    page = folder / "index.html"
    with whole_file(page) as stream:
        title = "Comparison: " + ", ".join(one.replay.name for one in compared)
        table = [
            [one.replay.name, name, *(["not logged"] * 3 if error is None else _cells(error))]
            for one in compared
            for name, error in one.replay.errors.items()
        ]
        text = discrepancy_page(
            title, sentences(last.places), ("model", "channel", "error", "floor", "r2"), table, rows,
            [(captions[name], svg) for name, svg in pictures.items()],
        )  # fmt: skip
        stream.write(text.encode())
    return [*files, page]


def _cells(error: object) -> list[str]:
    from hjcamp.discrepancy.replay import ChannelError

    assert isinstance(error, ChannelError)
    return [f"{error.rms:.4g}", *("" if one is None else f"{one:.4g}" for one in (error.floor, error.r2))]
