"""The plan of a sweep, shown without running it."""

from __future__ import annotations

import shlex
from pathlib import Path

from hjcamp.errors import counted

SHOWN = 20


def show_sweep(overrides: list[str], folder: Path | None) -> None:
    """Print the jobs of ``hjcamp run -m`` with these overrides, or where its sweeper will look, with tests and motion."""
    from rich.table import Table

    from hjcamp.campaign.execution.console import make_console
    from hjcamp.campaign.plan.planning import composed_plan
    from hjcamp.campaign.plan.sweep import read_sweep
    from hjcamp.commands.shared.duration import duration_text
    from hjcamp.configuration.composer import Composer, free
    from hjcamp.configuration.overrides import parse_overrides
    from hjcamp.configuration.trust import check_overrides

    composer = Composer(folder=folder)
    lines = [free(line) for line in overrides]
    parsed = parse_overrides(lines)
    check_overrides(lines, parse_overrides)
    sweep = read_sweep(parsed, composer)
    console = make_console()
    fixed = {f"{one.get_key_element()}={one.get_value_element_as_str()}" for one in parsed if not one.is_sweep_override()}
    table = Table(box=None, header_style="bold")
    for name in ("job", "varied", "conditions", "tests", "motion"):
        table.add_column(name, overflow="fold")
    tests, motion = 0, 0.0
    for number, job in enumerate(sweep.jobs):
        made = composed_plan(job, composer)[0]
        tests, motion = tests + len(made.tests), motion + made.duration
        name = ("lowest", "highest")[number] if sweep.space else str(number)
        own = " ".join(line for line in job if line not in fixed)
        if number < SHOWN:
            table.add_row(name, own, str(len(made.conditions)), str(len(made.tests)), duration_text(made.duration))
    for one in sweep.objectives:
        console.print(f"objective  {one.text}, the mean over the tests of a job", markup=False)
    if sweep.space:
        count = "an unknown number of" if sweep.count is None else str(sweep.count)
        console.print(f"{count} jobs, their values chosen by hydra/sweeper={sweep.sweeper}, one after the other", markup=False)
        for key, value in sweep.space.items():
            console.print(f"  {key} = {value}", markup=False)
        console.print("the two ends of what it may choose:")
        tests, motion = tests // 2 * (sweep.count or 1), motion / 2 * (sweep.count or 1)
    else:
        console.print(f"{len(sweep.jobs)} jobs")
    console.print(table)
    if len(sweep.jobs) > SHOWN:
        console.print(f"  ... and {len(sweep.jobs) - SHOWN} more")
    whole = f"{counted(tests, 'test')}, {duration_text(motion)} of motion" if not sweep.space or sweep.count else "not known"
    console.print(f"in all  {whole}", markup=False)
    console.print(f"next    hjcamp run -m {shlex.join(overrides)}", markup=False)
