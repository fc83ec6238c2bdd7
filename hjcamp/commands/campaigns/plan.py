"""Show what a run would do: conditions, tests, duration, configuration; --signals writes its tests for another rig."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.complete import complete_override
from hjcamp.commands.shared.duration import duration_text
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError, counted, unknown

if TYPE_CHECKING:
    from hjcamp.records.plan import Plan


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("plan")(plan)


def plan(
    overrides: Annotated[list[str] | None, typer.Argument(autocompletion=complete_override)] = None,
    condition: Annotated[
        str | None, typer.Option("--condition", help="Show the resolved configuration of this condition.")
    ] = None,
    cfg: Annotated[bool, typer.Option("--cfg", help="Show the resolved configuration of every condition.")] = False,
    config_dir: Annotated[Path | None, typer.Option("--config-dir", help="A further folder of groups.")] = None,
    signals: Annotated[
        Path | None,
        typer.Option(
            help="Write the tests as CSV for another rig or simulator into this folder, with the map for their import."
        ),
    ] = None,
    json: AnswerFile = None,
    multirun: Annotated[bool, typer.Option("--multirun", "-m", help="The plan of a sweep.")] = False,
) -> None:
    """Show what a run would do: conditions, tests, duration, configuration; --signals writes its tests for another rig."""
    check_answer_file(json)
    if multirun:
        from hjcamp.commands.shared.sweep_plan import show_sweep

        if json is not None or condition is not None or cfg or signals is not None:
            raise UsageError(
                "-m shows the jobs of a sweep; --json, --condition, --cfg and --signals are of one run: give one value each"
            )
        show_sweep(overrides or [], config_dir)
        return
    made = compose_plan(overrides or [], config_dir)
    written = tell_signals(made, signals) if signals is not None else []
    write_answer(json, made.as_json() | ({"signals": written} if written else {}))
    if condition is not None or cfg:
        show_configuration(made, condition)
    else:
        show_plan(made)


def compose_plan(overrides: list[str], config_dir: Path | None = None) -> Plan:
    """Return the plan of ``hjcamp run`` with these overrides."""
    from hjcamp.campaign.plan.planning import composed_plan
    from hjcamp.configuration.composer import Composer

    return composed_plan(overrides, Composer(folder=config_dir))[0]


def tell_signals(made: Plan, folder: Path) -> list[str]:
    """Write the signals of a plan's tests, say where they are, and return their files."""
    from hjcamp.analyses.signals import write_signals
    from hjcamp.campaign.execution.console import make_console

    files = write_signals(made, folder)
    console = make_console()
    console.print(
        f"signals  {counted(len(files) - 1, 'test')} in {folder}; {files[-1]} imports what was recorded", markup=False
    )
    return [str(path) for path in files]


def show_plan(made: Plan) -> None:
    """Print the plan as a person reads it."""
    from rich.table import Table

    from hjcamp.campaign.execution.before_moving import say_notices
    from hjcamp.campaign.execution.console import bold, make_console

    console = make_console()
    count = len(made.conditions)
    console.print(
        bold(
            made.campaign,
            f": {count} condition{'s' * (count != 1)} x {counted(made.repetitions, 'repetition')}"
            f" = {counted(len(made.tests), 'test')}, {duration_text(made.duration)} of motion",
        )
    )
    if made.description:
        console.print(f"  {made.description}", style="dim", markup=False)
    console.print(f"  {common_choices(made)}", markup=False)
    if made.fixed:
        console.print("  fixed   " + ", ".join(f"{key}={value}" for key, value in made.fixed.items()), markup=False)
    if made.axes:
        axes = [f"{name}  {' '.join(labels)}" for name, labels in made.axes.items()]
        console.print("  varies  " + "\n     x    ".join(axes), markup=False)
    say_notices(made, console)
    console.print(f"  tables  {' '.join(made.tables) or 'none but the table of conditions'}", markup=False)
    table = Table(box=None, header_style="bold")
    for name in ("condition", "tests", "motion"):
        table.add_column(name)
    for one in made.conditions:
        table.add_row(one.name, str(made.repetitions), f"{one.duration:g} s")
    console.print(table)
    console.print("  one condition in full: hjcamp plan ... --condition NAME", style="dim")


def common_choices(made: Plan) -> str:
    """Return the choices that all conditions share."""
    first, *others = [one.choices for one in made.conditions]
    shared = [(group, choice) for group, choice in first.items() if all(one.get(group) == choice for one in others)]
    return ", ".join(f"{group} {choice}" for group, choice in sorted(shared) if "/" not in group)


def show_configuration(made: Plan, name: str | None) -> None:
    """Print the resolved configuration of one condition, or of all."""
    from hjcamp.campaign.execution.one_test import configuration_text

    names = [one.name for one in made.conditions]
    if name is not None and name not in names:
        raise unknown("condition", name, names, f"campaign '{made.campaign}'")
    chosen: Any = [one for one in made.conditions if name in (None, one.name)]
    print("\n".join(f"# {one.name}\n{configuration_text(one)}" for one in chosen), end="")
