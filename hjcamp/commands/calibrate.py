"""Identify a rig's constants from its own logs and save them as configuration."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.analyses.calibrating import identify_pump_joint, pairs
from hjcamp.analyses.data import Data
from hjcamp.commands._session import AnswerFile
from hjcamp.errors import UsageError, counted
from hjcamp.known_plants import DEFAULT

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.calibrate.estimate import Estimate
    from hjcamp.plants.pump_joint.calibrate.identify import Calibration


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("calibrate")(calibrate)


def calibrate(
    paths: Annotated[list[Path], typer.Argument(help="Run folders, folders of logs, or log files.")],
    name: Annotated[str, typer.Option("--as", help="Name of the model and rig to write: conf/model/NAME.yaml.")],
    only: Annotated[
        list[str] | None, typer.Option(help="Only logs with this in their metadata: pump=pump2. May be repeated.")
    ] = None,
    conf: Annotated[Path, typer.Option(help="Configuration folder to write into.")] = Path("conf"),
    replace: Annotated[bool, typer.Option("--replace", help="Replace files of that name.")] = False,
    json: AnswerFile = None,
) -> None:
    """Identify a rig's constants from its own logs and save them as configuration."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._any_plant import calibrate_any
    from hjcamp.commands._session import check_answer_file, write_answer
    from hjcamp.plants.pump_joint.calibrate.configuration_file import check_name
    from hjcamp.report.identification_figures import identification_page
    from hjcamp.storage import whole_file

    check_answer_file(json)
    check_name(name, conf, replace)
    data = Data(paths)
    if not data.of_pump_joint:
        if only:
            raise UsageError(
                f"--only {only[0]}: it chooses logs of pump_joint; of plant {data.plant_name} name the logs themselves"
            )
        calibrate_any(data, name, json)
        return
    done = identify_pump_joint(data, name, pairs(only or []), conf, replace)
    found, model, rig = done.found, done.model, done.rig
    page = Path("calibration") / f"{name}.html"
    facts = [counted(found.tests, "test"), *(f"{group} {choice}" for group, choice in found.hardware.items())]
    charts = [chart for finding in found.findings.values() for chart in finding.charts]
    rows = [row_of(one) for one in found.estimates.values()]
    with whole_file(page) as stream:
        stream.write(identification_page(f"Calibration {name}", facts, rows, notes_of(found), charts).encode())
    write_answer(json, answer_of(found) | {"model": str(model), "rig": str(rig), "page": str(page)})
    _print(make_console(), found)
    console = make_console()
    console.print(f"  model   {model}   rig  {rig}", markup=False, soft_wrap=True)
    console.print(f"  page    {page}", markup=False, soft_wrap=True)
    console.print(f"  next    hjcamp run campaign=open_loop_validation model={name} rig={name}", markup=False)
    # Without the choice of --only the logs may be of several rigs, which no model fits.
    if not only:
        console.print(
            f"          hjcamp compare {' '.join(map(str, paths))} --model {name}", markup=False, soft_wrap=True
        )


def answer_of(found: Calibration) -> dict[str, Any]:
    """Return the constants with their 95 % intervals (SI), as a diagnosis tells its calibration."""
    rows = {
        name: {
            "published": one.published, "value": one.value, "unit": one.unit,
            "ci95": list(one.interval) if one.interval else None, "tests": one.tests, "text": one.text,
        }
        for name, one in found.estimates.items()
    }  # fmt: skip
    head = {"schema": "hjcamp.calibration/1", "plant": DEFAULT, "tests": found.tests, "hardware": dict(found.hardware)}
    return {**head, "calibration": rows, "notes": notes_of(found)}


def row_of(one: Estimate) -> list[str]:
    """Return what a table shows of an estimate: text, value, interval, published value, tests."""
    from hjcamp.plants.pump_joint.calibrate.estimate import significant

    scale, unit = one.shown_scale, one.shown_unit
    width = (one.interval[1] - one.interval[0]) * scale if one.interval else 0.0
    value = significant(one.value * scale, width) if one.interval else f"{one.value * scale:.4g}"
    interval = " to ".join(significant(end * scale, width) for end in one.interval) if one.interval else "none"
    published = "" if one.published is None else f"{one.published * scale:.4g}"
    return [one.text, f"{value} {unit}", interval, published, str(one.tests)]


def notes_of(found: Calibration) -> list[str]:
    """Return facts and warnings, each with its kind of test."""
    facts = [f"{kind}: {key}: {text}" for kind, one in found.findings.items() for key, text in one.facts.items()]
    return facts + [f"{kind}: warning: {text}" for kind, one in found.findings.items() for text in one.warnings]


def _print(console: object, found: Calibration) -> None:
    from rich.console import Console
    from rich.table import Table

    from hjcamp.report.identification_figures import HEADINGS

    assert isinstance(console, Console)
    for kind, finding in found.findings.items():
        if finding.estimates:
            table = Table(title=kind, title_justify="left", box=None, pad_edge=False)
            for heading in HEADINGS:
                table.add_column(heading, justify="left" if heading == "constant" else "right")
            for one in finding.estimates:
                table.add_row(*row_of(one))
            console.print(table)
        for key, text in finding.facts.items():
            console.print(f"  {key}: {text}", style="dim", markup=False)
        for text in finding.warnings:
            console.print(f"  warning  {text}", style="yellow", markup=False)
