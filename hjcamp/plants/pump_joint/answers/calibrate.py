"""`hjcamp calibrate` for tests of the joint: the constants of chapter 4."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data
from hjcamp.commands.shared.session import write_answer
from hjcamp.errors import counted
from hjcamp.plants.pump_joint.analyses.calibrating import identify_joint, pairs
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.calibrate.estimate import Estimate
    from hjcamp.plants.pump_joint.calibrate.identify import Calibration


def calibrate(data: Data, name: str, only: list[str], conf: Path, replace: bool, json: Path | None) -> None:
    """Identify the constants that these tests support, write model, rig and page."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.plants.pump_joint.figures.identification import identification_page

    done = identify_joint(data, name, pairs(only), conf, replace)
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
        console.print(f"          hjcamp compare {' '.join(map(str, data.paths))} --model {name}", markup=False, soft_wrap=True)


def answer_of(found: Calibration) -> dict[str, Any]:
    """Return the constants with their 95 % intervals (SI), as a diagnosis tells its calibration."""
    rows = {
        name: {
            "published": one.published,
            "value": one.value,
            "unit": one.unit,
            "ci95": list(one.interval) if one.interval else None,
            "tests": one.tests,
            "text": one.text,
        }
        for name, one in found.estimates.items()
    }
    head = {
        "schema": "hjcamp.calibration/1",
        "plant": "pump_joint",
        "tests": found.tests,
        "hardware": dict(found.hardware),
    }
    return {**head, "calibration": rows, "notes": notes_of(found)}


def row_of(one: Estimate) -> list[str]:
    """Return what a table shows of an estimate: text, value, interval, published value, tests."""
    value, ends = one.texts
    published = "" if one.published is None else f"{one.published * one.shown_scale:.4g}"
    return [one.text, f"{value} {one.shown_unit}", " to ".join(ends) or "none", published, str(one.tests)]


def notes_of(found: Calibration) -> list[str]:
    """Return facts and warnings, each with its kind of test."""
    facts = [f"{kind}: {key}: {text}" for kind, one in found.findings.items() for key, text in one.facts.items()]
    return facts + [f"{kind}: warning: {text}" for kind, one in found.findings.items() for text in one.warnings]


def _print(console: object, found: Calibration) -> None:
    from rich.console import Console
    from rich.table import Table

    from hjcamp.plants.pump_joint.figures.identification import HEADINGS

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
