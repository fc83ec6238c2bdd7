"""The end of a run: tables, report page, what to do next."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from hjcamp.calibrate.string_slip import string_warning
from hjcamp.campaign.folder import RunFolder
from hjcamp.campaign.runner import RunResult
from hjcamp.errors import HjcampError, RigStopped

if TYPE_CHECKING:
    from rich.console import Console

SHOWN = 5
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


def conclude(folder: RunFolder, result: RunResult, console: Console) -> None:
    """Build the report of what is there and print the tables; raises where tests failed.

    ``RigStopped`` (exit code 3) where the rig was made safe on the way, ``HjcampError`` (1) otherwise.
    """
    total = len(folder.plan.tests)
    kept = f", {result.kept} were there" if result.kept else ""
    console.print(f"[bold]{folder.path}[/bold]   {total} tests, {len(result.failures)} failed{kept}")
    for text, count in grouped(result.warnings)[:SHOWN]:
        console.print(f"  note    {text} ({count} test{'s' * (count != 1)})", style="yellow", markup=False)
    for slip in dict.fromkeys(string_warning(one.config) for one in folder.plan.conditions):
        if slip:
            console.print(f"  note    {slip}", style="yellow", markup=False)
    if result.done + result.kept:
        _report(folder, console)
    if result.failures:
        lines = [f"{test}: {message}" for test, message in result.failures[:SHOWN]]
        more = [f"... and {len(result.failures) - SHOWN} more: hjcamp show {folder.path}"]
        text = "\n  ".join(lines + (more if len(result.failures) > SHOWN else []))
        left = sum(entry["state"] != "done" for entry in folder.manifest["tests"].values())
        kind = RigStopped if result.made_safe else HjcampError
        raise kind(f"{len(result.failures)} tests failed\n  {text}\n{left} to go: hjcamp resume {folder.path}")


def grouped(warnings: Mapping[str, int]) -> list[tuple[str, int]]:
    """Return warnings that differ only in their numbers as one, in the words of the most frequent; most tests first."""
    groups: dict[str, list[tuple[str, int]]] = {}
    for text, count in warnings.items():
        groups.setdefault(NUMBER.sub("#", text), []).append((text, count))
    examples = [(max(members, key=lambda member: member[1])[0], members) for members in groups.values()]
    found = [
        (text if len(members) == 1 else f"{text}, and alike", sum(count for _, count in members))
        for text, members in examples
    ]
    return sorted(found, key=lambda item: -item[1])


def _report(folder: RunFolder, console: Console) -> None:
    from hjcamp.campaign.identification import identification_pictures
    from hjcamp.report.build import build_report, verdict
    from hjcamp.report.terminal import summary_table

    report = build_report(folder.path, against="published", further=identification_pictures)
    console.print(summary_table(report.indicators))
    sentence = verdict(report.comparison, report.differs)
    if sentence:
        console.print(f"  {sentence}", markup=False)
    console.print(f"  report  {report.page}", markup=False, soft_wrap=True)
    console.print(f"  next    hjcamp compare {folder.path}", markup=False, soft_wrap=True)
    console.print(f"          hjcamp report {folder.path} --check default", markup=False, soft_wrap=True)
