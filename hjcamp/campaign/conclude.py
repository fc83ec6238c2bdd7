"""The end of a run: tables, report page, what to do next."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.campaign.folder import RunFolder
from hjcamp.campaign.runner import RunResult
from hjcamp.errors import HjcampError, RigStopped, UsageError, counted
from hjcamp.known_plants import DEFAULT
from hjcamp.plants.pump_joint.calibrate.string_slip import string_warning

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.report.build import Report

SHOWN = 5
#: The campaigns whose logs `hjcamp calibrate` reads.
IDENTIFIED = ("pump_step", "compliance", "leakage", "friction")
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


def conclude(folder: RunFolder, result: RunResult, console: Console) -> Report | None:
    """Build the report of what is there, print the tables and return it, None without any test; raises where tests failed.

    ``RigStopped`` (exit code 3) where the rig was made safe on the way, ``HjcampError`` (1) otherwise.
    """
    total = len(folder.plan.tests)
    kept = f", {result.kept} were there" if result.kept else ""
    console.print(f"[bold]{folder.path}[/bold]   {counted(total, 'test')}, {len(result.failures)} failed{kept}")
    for text, count in grouped(result.warnings)[:SHOWN]:
        console.print(f"  note    {text} ({count} test{'s' * (count != 1)})", style="yellow", markup=False)
    joints = [one.config for one in folder.plan.conditions if not one.config.get("plant")]
    for slip in dict.fromkeys(map(string_warning, joints)):
        if slip:
            console.print(f"  note    {slip}", style="yellow", markup=False)
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
        groups.setdefault(NUMBER.sub("#", text), []).append((text, count))
    examples = [(max(members, key=lambda member: member[1])[0], members) for members in groups.values()]
    found = [
        (text if len(members) == 1 else f"{text}, and alike", sum(count for _, count in members))
        for text, members in examples
    ]
    return sorted(found, key=lambda item: -item[1])


def _report(folder: RunFolder, console: Console) -> Report:
    from hjcamp.campaign.study_pictures import study_pictures
    from hjcamp.report.build import build_report, verdict
    from hjcamp.report.terminal import summary_table

    report = build_report(folder.path, against="published", further=study_pictures)
    console.print(summary_table(report.indicators))
    sentence = verdict(report.comparison, report.differs)
    if sentence:
        console.print(f"  {sentence}", markup=False)
    console.print(f"  report  {report.page}", markup=False, soft_wrap=True)
    for number, command in enumerate(next_commands(folder, report)):
        console.print(f"  {'' if number else 'next':<8}{command}", markup=False, soft_wrap=True)
    return report


def next_commands(folder: RunFolder, report: Report) -> list[str]:
    """Return what helps now, each command whole and fit to be run: the tests of one rig, and no check that must fail."""
    from hjcamp.records.find import ANALYSED, HARDWARE
    from hjcamp.report.check import check

    run = shlex.quote(str(folder.path))
    conditions = folder.plan.conditions
    if any((one.choices.get("plant") or DEFAULT) not in ANALYSED for one in conditions):
        return []
    rigs = {tuple((group, one.choices.get(group)) for group in HARDWARE): None for one in conditions}
    first = next(iter(rigs))
    if folder.plan.campaign in IDENTIFIED:
        only = [f" --only {group}={name}" for group, name in first if len({dict(rig)[group] for rig in rigs}) > 1]
        return [f"hjcamp calibrate {run} --as {_free_model()}{''.join(only)}"]
    paths = [run]
    if len(rigs) > 1:
        own = [one.name for one in conditions if tuple((group, one.choices.get(group)) for group in HARDWARE) == first]
        there = [folder.path / "logs" / name for name in own]
        paths = [shlex.quote(str(path)) for path in there if path.is_dir()]
    commands = [f"hjcamp compare {' '.join(paths)}"] if paths else []
    try:
        passes = not check(report.comparison)
    except UsageError:
        return commands
    return [*commands, f"hjcamp report {run} --check default"] if passes else commands


def _free_model() -> str:
    names = (f"my_rig{number}" for number in ("", *range(2, 1000)))
    places = [Path("conf") / group for group in ("model", "rig")]
    return next(name for name in names if not any((place / f"{name}.yaml").exists() for place in places))
