"""A few minutes with sample logs: find the effect that hides in them, add it, see the error fall, open the answer."""

from __future__ import annotations

import shlex
import sys
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hjcamp.errors import UsageError, unknown
from hjcamp.storage import write_whole

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.plants.pump_joint.tour.kinds import Tour

EFFORTS = ("quick", "standard", "thorough")
PICTURE = "error_falls.svg"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("tour")(tour)


def tour(
    plant: Annotated[bool, typer.Option("--plant", help="Of a machine that is not the joint: a spindle.")] = False,
    into: Annotated[
        Path | None, typer.Option(help="The folder of the tour; tour, with --plant tour_plant.", show_default=False)
    ] = None,
    step: Annotated[int | None, typer.Option(help="Do this step alone, from 1 on.")] = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not wait between the steps.")] = False,
    open_: Annotated[bool, typer.Option("--open", help="Open the sealed answer.")] = False,
    effort: Annotated[str, typer.Option(help="Of the diagnosis: quick, standard or thorough.")] = "quick",
) -> None:
    """A few minutes with sample logs: find the effect that hides in them, add it, see the error fall, open the answer."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.warm import wait
    from hjcamp.plants.pump_joint.tour.kinds import Tour
    from hjcamp.plants.pump_joint.tour.spindle import SPINDLE
    from hjcamp.plants.pump_joint.tour.steps import JOINT

    kind = SPINDLE if plant else JOINT
    if effort not in EFFORTS:
        raise unknown("effort", effort, EFFORTS)
    if step is not None and not 1 <= step <= len(kind.steps):
        raise UsageError(f"--step {step}: the steps are 1 to {len(kind.steps)}")
    if open_ and step is not None:
        raise UsageError("--open and --step: give one of them")
    console, here = make_console(), Tour(into or kind.folder, kind, effort)
    if open_:
        open_answer(console, here)
        return
    if step is not None:
        kind.steps[step - 1].words(here)  # says what has to be done before, and nothing is written
    count = kind.lay_out(here.folder)
    first, last = (step, step) if step else (here.next_step(), len(kind.steps))
    if first == 1:
        say(console, kind.introduction.format(count=count, folder=here.folder))
    elif step is None:
        say(console, f"The tour in {here.folder} goes on with step {first}; --step 1 begins again.")
    if not plant:
        wait(console)
    for number in range(first, last + 1):
        if not (number == first or yes) and not goes_on(console, number):
            return
        do_step(console, here, number)


def do_step(console: Console, tour: Tour, number: int) -> None:
    """Say what to look at, show the command, run it, and say where the pictures are."""
    from hjcamp.commands import command_files, load
    from hjcamp.plants.pump_joint.tour.kinds import effects_to_add, last_sentence

    kind = tour.kind
    step = kind.steps[number - 1]
    words = step.words(tour)
    console.print()
    console.print(f"Step {number} of {len(kind.steps)}: {step.title}", style="bold cyan")
    say(console, step.look)
    if number == kind.adding and (verdict := tour.answer(kind.diagnosing)["verdict"]) != "effect":
        chosen = ", ".join(effects_to_add(tour.answer(kind.diagnosing)))
        say(console, f"The diagnosis did not settle on an effect ({verdict}); its best candidate is added: {chosen}.")
    console.print(f"\n$ hjcamp {shlex.join(words)}", style="bold", markup=False)
    if words[0] == "tour":
        open_answer(console, tour)
        return
    for name in step.writes:
        (tour.folder / name).unlink(missing_ok=True)
    code = load(command_files()[words[0]]).main(args=words[1:], prog_name=f"hjcamp {words[0]}", standalone_mode=False)
    if isinstance(code, int) and code:
        raise typer.Exit(code)
    console.print()
    if step.page:
        page = (tour.folder / step.page / "index.html").resolve()
        console.print(f"look at {page.as_uri()}", style="cyan", markup=False)
    if number == kind.adding:
        console.print(f"read    {tour.answer(number)['file']}", style="cyan", markup=False)
    say(console, last_sentence(tour.answer(number)))


def open_answer(console: Console, tour: Tour) -> None:
    """Print what hides in the recordings and what was found, draw how the error fell, and say what to do next."""
    from hjcamp.plants.pump_joint.tour.answer import print_answer

    kind = tour.kind
    done = {number: tour.answer(number) for number in (kind.diagnosing, kind.adding) if tour.answer_file(number).is_file()}
    try:
        print_answer(console, done.get(kind.diagnosing), kind.sealed, " ".join(["hjcamp tour", *kind.option]))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise tour.again(kind.diagnosing) from error
    if kind.adding not in done:
        return
    tell_of_fall(console, tour)
    for number, command in enumerate(kind.after):
        line = command.format(model=done[kind.adding]["model"])
        console.print(f"{'' if number else 'next':<12}{line}", markup=False)
    console.print("            hjcamp diagnose YOUR_LOGS", markup=False)
    written = [str(tour.folder), str(done[kind.adding]["file"]), *kind.written]
    console.print(f"clear away  rm -r {shlex.join(written)}", markup=False)


def tell_of_fall(console: Console, tour: Tour) -> None:
    """Say by how much the error fell on what was not used for the fit, and draw it."""
    from hjcamp.report.pictures.drawing import draw_errors

    try:
        rows = [(name, float(value)) for name, value in tour.kind.fall(tour)]
    except (KeyError, TypeError, ValueError, UsageError):
        return  # the steps with these numbers were not done
    write_whole(tour.folder / PICTURE, draw_errors(rows, tour.kind.held_out))
    fall = ", ".join(f"{name} {value:.2f}" for name, value in rows)
    say(console, f"{tour.kind.held_out[0].upper()}{tour.kind.held_out[1:]}: {fall}.")
    console.print(f"picture     {tour.folder / PICTURE}", style="cyan", markup=False)


def say(console: Console, text: str) -> None:
    """Print a paragraph, wrapped to a width that reads well."""
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
