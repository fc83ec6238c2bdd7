"""Show the plants, or one of them with its places and the effects that fit; write and test a plant of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.campaign.execution.console import bold, make_console
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, check_picture, write_answer
from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.model.declare.plant import Plant

USAGE = "hjcamp plants [NAME] | plants new NAME | plants test NAME"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("plants")(plants)


def plants(
    words: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME | new NAME | test NAME]", help="A plant; none for the list.", show_default=False),
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(help="Write the block diagram of NAME to this .svg, .png or .pdf.", show_default=False),
    ] = None,
    json: AnswerFile = None,
) -> None:
    """Show the plants, or one of them; write and test a plant of one's own."""
    check_answer_file(json)
    match words or []:
        case []:
            write_answer(json, show_list())
        case ["new", name]:
            write_answer(json, {"schema": "hjcamp.template/1", "name": name, "file": str(write_new(name))})
        case ["test", name]:
            write_answer(json, run_tests(name))
        case ["new" | "test", *_]:
            raise UsageError(f"give one name: {USAGE}")
        case [name]:
            write_answer(json, show_plant(name, figure))
        case _:
            raise UsageError(f"give one name: {USAGE}")


def show_list() -> dict[str, Any]:
    """Print every plant: what it is, what is measured, how many effects fit."""
    from rich.table import Table

    from hjcamp.commands.shared.answers import plant_row
    from hjcamp.effects import library_of
    from hjcamp.known_plants import plants_and_faults

    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("plant", "what it is", "measured", "effects that fit"):
        table.add_column(column, no_wrap=column == "plant")
    found, faults = plants_and_faults()
    for name, plant in found.items():
        measured = [channel.field for channel in plant.channels] or list(plant.measured)
        table.add_row(name, plant.sentence(), ", ".join(measured), str(len(library_of(plant).effects)))
    console = make_console()
    console.print(table)
    for problem in faults.values():
        console.print(f"  not a plant: {problem}", style="red", markup=False, soft_wrap=True)
    console.print("  one of them: hjcamp plants NAME; one of your own: hjcamp plants new NAME", style="dim", markup=False)
    rows = [plant_row(plant, list(library_of(plant).effects)) for plant in found.values()]
    return {"schema": "hjcamp.plants/1", "plants": rows}


def show_plant(name: str, figure: Path | None) -> dict[str, Any]:
    """Print one plant: states, inputs, parameters, lines, places, and which effects fit."""
    from hjcamp.commands.shared.answers import plant_answer
    from hjcamp.effects import library_of
    from hjcamp.known_plants import find_plant
    from hjcamp.model.checks.plant_checks import check_plant

    if figure is not None:
        check_picture(figure)
    plant = find_plant(name)
    check_plant(plant)
    console = make_console()
    console.print(bold(name, f"  {plant.sentence()}"))
    if plant.equation():
        console.print(f"  {plant.equation()}", markup=False)
    _declared(console, plant)
    _lines(console, plant)
    _places(console, plant)
    _effects(console, plant)
    _import_map(console, plant)
    if figure is not None:
        from hjcamp.report.pictures.plant import draw_plant

        draw_plant(figure, plant)
        console.print(f"\n  picture  {figure}", markup=False, soft_wrap=True)
    library = library_of(plant)
    return plant_answer(plant, list(library.effects), library.unfit)


def _declared(console: Console, plant: type[Plant]) -> None:
    from rich.table import Table

    table = Table(box=None, header_style="bold", padding=(0, 2, 0, 0))
    for column in ("", "name", "unit", "value", "meaning"):
        table.add_column(column, no_wrap=column in ("", "name", "unit"))
    for row in declared_rows(plant):
        table.add_row(*row.values())
    console.print()
    console.print(table)


def declared_rows(plant: type[Plant]) -> list[dict[str, str]]:
    """Return what a plant declares: kind, name, unit, value and meaning of states, inputs, parameters, what is measured."""
    from hjcamp.model.declare.plant import ALWAYS

    rows = [("state", one.name, one.unit, f"about {one.typical:g}", one.text) for one in plant.states.values()]
    for given in (one for one in plant.inputs.values() if one.name not in ALWAYS or one is not ALWAYS[one.name]):
        rows.append(("input", given.name, given.unit, "", given.text))
    for item in plant.parameters.values():
        kind = "base" if item.name in plant.base_parameters else "parameter"
        rows.append((kind, item.name, item.unit, f"{item.default:g}", item.text))
    rows += [("measured", channel.field, "", "", f"shows {channel.signal}") for channel in plant.channels]
    rows += [("measured", one.name, "", "", one.text or f"shows {one.sensor}") for one in plant.measured.values()]
    for phases, when in ((plant.phases_before, "before the motion"), (plant.phases_after, "after the motion")):
        for phase in phases:
            ways = ", ".join(f"{name} to {value:g} {plant.inputs[name].unit}" for name, value in phase.to.items())
            rows.append(("phase", phase.name, "s", f"{phase.seconds:g}", f"{when}: {ways or 'inputs stay'}"))
    return [dict(zip(("kind", "name", "unit", "value", "meaning"), row, strict=True)) for row in rows]


def _lines(console: Console, plant: type[Plant]) -> None:
    from hjcamp.model.language.vocabulary import read_vocabulary

    console.print(bold("equations", ", elements written out; an effect may change a slot and read all", before="\n  "))
    marks = {"slot": "slot", "signal": "", "plain": "", "rate": "rate"}
    for line in read_vocabulary(plant).statements:
        unit = f"  [{line.unit}]" if line.unit else ""
        target = f"rate.{line.target}" if line.mark == "rate" else line.target
        console.print(f"  {marks[line.mark]:<5} {target} = {line.expression}{unit}", markup=False, soft_wrap=True)


def _places(console: Console, plant: type[Plant]) -> None:
    from hjcamp.model.language.vocabulary import read_vocabulary

    ports = read_vocabulary(plant).ports.values()
    if ports:
        console.print(bold("places", before="\n  "))
    for port in ports:
        names = ", ".join(f"{local}={name}" if local != name else name for local, name in port.names.items())
        console.print(f"  {port.kind:<12} {port.name}: {names}", markup=False, soft_wrap=True)


def _effects(console: Console, plant: type[Plant]) -> None:
    from hjcamp.effects import library_of

    library = library_of(plant)
    console.print(bold("effects that fit", f" ({len(library.effects)})", before="\n  "))
    for name, effect in library.effects.items():
        console.print(f"  {name}: {effect.sentence()}", markup=False, soft_wrap=True)
    if library.unfit:
        console.print(bold("effects that do not", f" ({len(library.unfit)})", before="\n  "), style="dim")
    for reason in library.unfit.values():
        console.print(f"  {reason}", style="dim", markup=False, soft_wrap=True)


def _import_map(console: Console, plant: type[Plant]) -> None:
    from hjcamp.records.elsewhere.import_map import example_map

    console.print(
        bold("map for hjcamp import", ": name your columns and their units, leave out what you have not\n", before="\n  ")
    )
    console.print(example_map(plant), markup=False, soft_wrap=True, highlight=False)


def write_new(name: str) -> Path:
    """Write the template of a plant into ./plants."""
    from hjcamp.commands.shared.plant_template import write_template
    from hjcamp.known_plants import plants_and_faults

    path = write_template(name, Path("plants"), plants_and_faults()[0])
    console = make_console()
    console.print(f"  written  {path}", markup=False)
    console.print(f"  next     hjcamp plants test {name}", markup=False)
    return path


def run_tests(name: str) -> dict[str, Any]:
    """Run the checks that every plant passes on one plant."""
    from hjcamp.effects import library_of
    from hjcamp.known_plants import find_plant
    from hjcamp.model.checks.plant_bench import effects_seen, identified
    from hjcamp.model.checks.plant_checks import CHECKS, check_pushes
    from hjcamp.model.checks.plant_clock import time_constants

    plant = find_plant(name)
    console, passed = make_console(), {}
    for check, passes in {**CHECKS, "pushes": check_pushes, "time constants": time_constants}.items():
        passed[check] = str(passes(plant))
        console.print(f"  {check:<26} {passed[check]}", markup=False)
    if plant.measured:
        with console.status("compiling two kernels of this plant and running it"):
            told, seen = identified(plant), effects_seen(plant, library_of(plant).effects)
        console.print(f"  {'base identifiable':<26} {told}", markup=False)
        console.print(f"  {'effects that show':<26} {seen}", markup=False)
        passed |= {"base identifiable": str(told), "effects that show": str(seen)}
    console.print(bold(name, f" passes; see what fits it: hjcamp plants {name}"))
    return {"schema": "hjcamp.checks/1", "of": "plant", "passed": [{"name": name, "checks": passed}]}
