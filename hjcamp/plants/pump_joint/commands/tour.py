"""Ten minutes with sample logs: find the effect that hides in them, add it, see the error fall, open the answer."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hjcamp.errors import UsageError, unknown

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.plants.pump_joint.tour.steps import Tour

EFFORTS = ("quick", "standard", "thorough")
DIAGNOSING, ADDING = 2, 3
INTRODUCTION = (
    "A rig was tested: {count} logs, 8 conditions with 3 repetitions each, are in {logs}. Something hides in that rig "
    "that the published model does not know. Five steps find it. Each shows the command that it runs, so that you can "
    "repeat it. Where kernels are not compiled yet, the first two steps take one or two minutes longer."
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("tour")(tour)


def tour(
    into: Annotated[Path, typer.Option(help="The folder of the tour.")] = Path("tour"),
    step: Annotated[int | None, typer.Option(help="Do this step alone, 1 to 5.")] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not wait between the steps.")] = False,
    open_: Annotated[bool, typer.Option("--open", help="Open the sealed answer.")] = False,
    effort: Annotated[str, typer.Option(help="Of the diagnosis: quick, standard or thorough.")] = "quick",
) -> None:
    """Ten minutes with sample logs: find the effect that hides in them, add it, see the error fall, open the answer."""
    from hjcamp.campaign.console import make_console
    from hjcamp.plants.pump_joint.tour.samples import lay_out
    from hjcamp.plants.pump_joint.tour.steps import STEPS, Tour

    if effort not in EFFORTS:
        raise unknown("effort", effort, EFFORTS)
    if step is not None and not 1 <= step <= len(STEPS):
        raise UsageError(f"--step {step}: the steps are 1 to {len(STEPS)}")
    if open_ and step is not None:
        raise UsageError("--open and --step: give one of them")
    console, here = make_console(), Tour(into, effort)
    if open_:
        open_answer(console, here)
        return
    if step is not None:
        STEPS[step - 1].words(here)  # says what has to be done before, and nothing is written
    count = lay_out(into)
    first, last = (step, step) if step else (here.next_step(), len(STEPS))
    if first == 1:
        say(console, INTRODUCTION.format(count=count, logs=into / "logs"))
    elif step is None:
        say(console, f"The tour in {into} goes on with step {first}; --step 1 begins anew.")
    for number in range(first, last + 1):
        if not (number == first or yes) and not goes_on(console, number):
            return
        do_step(console, here, number)


def do_step(console: Console, tour: Tour, number: int) -> None:
    """Say what to look at, show the command, run it, and say where the pictures are."""
    from hjcamp.commands import command_files, load
    from hjcamp.plants.pump_joint.tour.steps import STEPS, effects_to_add

    step = STEPS[number - 1]
    words = step.words(tour)
    console.print()
    console.print(f"Step {number} of {len(STEPS)}: {step.title}", style="bold cyan")
    say(console, step.look)
    if number == ADDING and (verdict := tour.answer(DIAGNOSING)["verdict"]) != "effect":
        chosen = ", ".join(effects_to_add(tour.answer(DIAGNOSING)))
        say(console, f"The diagnosis did not settle on an effect ({verdict}); its best candidate is added: {chosen}.")
    console.print(f"\n$ hjcamp {shlex.join(words)}", style="bold", markup=False)
    if words[0] == "tour":
        open_answer(console, tour)
        return
    load(command_files()[words[0]]).main(args=words[1:], prog_name=f"hjcamp {words[0]}", standalone_mode=False)
    if step.page:
        page = (tour.folder / step.page / "index.html").resolve()
        console.print(f"\nlook at {page.as_uri()}", style="cyan", markup=False)
    if number == ADDING:
        console.print(f"\nread    {tour.answer(ADDING)['file']}", style="cyan", markup=False)


def open_answer(console: Console, tour: Tour) -> None:
    """Print what hides in the sample logs beside what was found, and what to do next."""
    from hjcamp.plants.pump_joint.tour.answer import print_answer

    done = {number: tour.answer(number) for number in (DIAGNOSING, ADDING) if tour.answer_file(number).is_file()}
    try:
        print_answer(console, done.get(DIAGNOSING))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise tour.again(DIAGNOSING) from error
    if ADDING in done:
        model, file = done[ADDING]["model"], done[ADDING]["file"]
        console.print(f"next        hjcamp run campaign=controllers controller.model={model}", markup=False)
        console.print("            hjcamp diagnose YOUR_LOGS", markup=False)
        console.print(f"clear away  rm -r {shlex.quote(str(tour.folder))} {shlex.quote(file)}", markup=False)


def say(console: Console, text: str) -> None:
    """Print a paragraph, wrapped to a width that reads well."""
    import textwrap

    for line in textwrap.wrap(text, min(console.width, 100), break_on_hyphens=False):
        console.print(line, markup=False)


def goes_on(console: Console, number: int) -> bool:
    """Wait for Enter before a step, on a terminal; return whether to go on."""
    if not (sys.stdin.isatty() and console.is_terminal):
        return True
    try:
        answer = console.input(f"\nEnter: step {number}    q: stop here, `hjcamp tour` goes on later   ")
    except EOFError:
        return False
    return answer.strip().lower() not in ("q", "quit")
