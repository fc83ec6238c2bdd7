"""The end of a run: tables, report page, what to do next."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from types import ModuleType
from typing import TYPE_CHECKING

from hjcamp.campaign.execution.console import bold
from hjcamp.campaign.files.run_folder import RunFolder
from hjcamp.campaign.runner import RunResult
from hjcamp.errors import HjcampError, RigStopped, counted, without_numbers
from hjcamp.known_plants import DEFAULT, plant_called, plant_of

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.report.build import Report

SHOWN = 5
READABLE = 100


def conclude(folder: RunFolder, result: RunResult, console: Console) -> Report | None:
    """Build the report of what is there, print the tables and return it, None without any test; raises where tests failed.

    ``RigStopped`` (exit code 3) where the rig was made safe on the way, ``HjcampError`` (1) otherwise.
    """
    total = len(folder.plan.tests)
    kept = f", {result.kept} were there" if result.kept else ""
    console.print(bold(str(folder.path), f"   {counted(total, 'test')}, {len(result.failures)} failed{kept}"))
    for text, count in grouped(result.warnings)[:SHOWN]:
        console.print(f"  note    {text} ({counted(count, 'test')})", style="yellow", markup=False)
    configs = [(plant_of(one.config).room_of("run"), one.config) for one in folder.plan.conditions]
    for note in dict.fromkeys(room.note(config) for room, config in configs if room):
        if note:
            console.print(f"  note    {note}", style="yellow", markup=False)
    report = _report(folder, console) if result.done + result.kept else None
    if result.failures:
        lines = [f"{test}: {message}" for test, message in result.failures[:SHOWN]]
        more = [f"... and {len(result.failures) - SHOWN} more: hjcamp show {folder.path}"]
        text = "\n  ".join(lines + (more if len(result.failures) > SHOWN else []))
        left = sum(entry["state"] != "done" for entry in folder.manifest["tests"].values())
        kind = RigStopped if result.made_safe else HjcampError
        raise kind(f"{counted(len(result.failures), 'test')} failed\n  {text}\n{left} to go: hjcamp resume {folder.path}")
    return report


def grouped(warnings: Mapping[str, int]) -> list[tuple[str, int]]:
    """Return warnings that differ only in their numbers as one, in the words of the most frequent; most tests first."""
    groups: dict[str, list[tuple[str, int]]] = {}
    for text, count in warnings.items():
        groups.setdefault(without_numbers(text), []).append((text, count))
    examples = [(max(members, key=lambda member: member[1])[0], members) for members in groups.values()]
    found = [
        (text if len(members) == 1 else f"for example: {text}", sum(count for _, count in members))
        for text, members in examples
    ]
    return sorted(found, key=lambda item: -item[1])


def _report(folder: RunFolder, console: Console) -> Report:
    from hjcamp.campaign.further_pictures import further_pictures
    from hjcamp.report.build import build_report, verdict
    from hjcamp.report.tables.factors import MOST_ROWS, effects_sheet
    from hjcamp.report.tables.terminal import FittedSheet, refitted_table, summary_table

    report = build_report(folder.path, against="published", further=further_pictures)
    console.print(summary_table(report.indicators))
    if (sheet := effects_sheet(report.effects, MOST_ROWS)) is not None:
        console.print(bold(sheet.title, before="\n"))
        console.print(FittedSheet(sheet))
    sentence = verdict(report.comparison, report.differs)
    if sentence:
        console.print(f"  {sentence}", markup=False)
    if report.refitted is not None:
        console.print(refitted_table(report.refitted))
        for line in textwrap.wrap(report.refitted.notes[1], min(console.width, READABLE) - 2):
            console.print(f"  {line}", markup=False)
    console.print(f"  report  {report.page}", markup=False, soft_wrap=True)
    for number, command in enumerate(next_commands(folder, report)):
        console.print(f"  {'' if number else 'next':<8}{command}", markup=False, soft_wrap=True)
    return report


def next_commands(folder: RunFolder, report: Report) -> list[str]:
    """Return what helps now, each command whole and fit to be run; nothing where no plant of the run says so."""
    room = _room_of(folder)
    return list(room.next_commands(folder, report)) if room else []


def _room_of(folder: RunFolder) -> ModuleType | None:
    """Return the module of the plant that all conditions of a run are of, where it has one for runs."""
    plants = {plant_called(one.choices.get("plant") or DEFAULT) for one in folder.plan.conditions}
    return plants.pop().room_of("run") if len(plants) == 1 else None
