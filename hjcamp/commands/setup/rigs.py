"""Show the rigs of one's own, each a file in ./rigs; write and test one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import HjcampError, UsageError

if TYPE_CHECKING:
    from hjcamp.rigs.rig import Rig

USAGE = "hjcamp rigs | rigs new NAME [--plant PLANT] [--serial | --daqmx] | rigs test NAME"


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("rigs")(rigs)


def rigs(
    words: Annotated[
        list[str] | None,
        typer.Argument(metavar="[new NAME | test NAME]", help="None for the list.", show_default=False),
    ] = None,
    plant: Annotated[str, typer.Option(help="With new: the plant on the rig.", show_default=False)] = "",
    serial: Annotated[bool, typer.Option("--serial", help="With new: a device on a serial line.")] = False,
    daqmx: Annotated[bool, typer.Option("--daqmx", help="With new: a converter of National Instruments.")] = False,
    json: AnswerFile = None,
) -> None:
    """Show the rigs of one's own; write one, and test it against a driver with every fault."""
    check_answer_file(json)
    match words or []:
        case []:
            write_answer(json, show_list())
        case ["new", name]:
            if serial and daqmx:
                raise UsageError(f"--serial or --daqmx, not both: {USAGE}")
            kind = "serial" if serial else "daqmx" if daqmx else "driver"
            write_answer(json, {"schema": "hjcamp.template/1", "name": name, "file": str(write_new(name, plant, kind))})
        case ["test", name]:
            write_answer(json, run_tests(name))
        case _:
            raise UsageError(f"give one name: {USAGE}")


def show_list() -> dict[str, Any]:
    """Print every rig: its plant, its channels, what guards it."""
    from rich.table import Table

    from hjcamp.campaign.execution.console import make_console
    from hjcamp.model.files.user_file import file_of
    from hjcamp.rigs import SHIPPED, rigs_and_faults

    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("rig", "plant", "what it is", "channels", "guard"):
        table.add_column(column, no_wrap=column == "rig")
    rows: list[dict[str, Any]] = []
    found, faults = rigs_and_faults()
    for name, text in SHIPPED.items():
        table.add_row(name, "any", text, "all", "nothing can be hurt")
        rows.append({"name": name, "plant": "", "text": text, "channels": [], "file": ""})
    for name, one in found.items():
        channels = [channel.name for channel in one.channels]
        guard = f"watchdog {one.watchdog_s:g} s" if one.watchdog_s else one.interlock or "-"
        table.add_row(name, one.plant or "any", one.sentence(), ", ".join(channels), guard)
        rows.append(
            {"name": name, "plant": one.plant, "text": one.sentence(), "channels": channels, "file": file_of(one.__module__)}
        )
    console = make_console()
    console.print(table)
    for problem in faults.values():
        console.print(f"  not a rig: {problem}", style="red", markup=False, soft_wrap=True)
    console.print("  a file in ./rigs is a program: this list has run it", style="dim", markup=False)
    console.print("  one of your own: hjcamp rigs new NAME", style="dim", markup=False)
    return {"schema": "hjcamp.rig_files/1", "rigs": rows}


def write_new(name: str, plant: str, kind: str) -> Path:
    """Write the template of a rig into ./rigs."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.rig_template import write_rig_template
    from hjcamp.known_plants import DEFAULT, find_plant, plant_names
    from hjcamp.model.files.user_folders import extension_folders
    from hjcamp.rigs import SHIPPED

    own = [one for folder in extension_folders("plants") for one in plant_names(folder)]
    if plant == DEFAULT:
        raise UsageError(f"plant {DEFAULT} has its rig in conf/rig/NAME.yaml (docs/rig.md)")
    if not plant and len(own) != 1:
        raise UsageError(
            f"say which plant is on the rig: --plant NAME; yours: {', '.join(own) or 'none (hjcamp plants new NAME)'}"
        )
    path = write_rig_template(name, find_plant(plant or own[0], "--plant"), kind, Path("rigs"), SHIPPED)
    console = make_console()
    console.print(f"  written  {path}", markup=False)
    console.print(f"  next     hjcamp rigs test {name}", markup=False)
    return path


def run_tests(name: str) -> dict[str, Any]:
    """Run the loop with a rig's channels on a fake driver that fails in every way; nothing of the rig is opened."""
    from hjcamp.backends.rig.any_plant.bench import WAYS, tried
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.configuration.check import check_configuration
    from hjcamp.rigs import find_rig

    rig = find_rig(name)
    if not rig.plant:
        raise UsageError(f"rig '{name}': say of which plant it is: plant = 'NAME'")
    config = config_with_motion(rig)
    check_configuration(config)
    console, passed, failed = make_console(), {}, []
    with console.status("compiling") as state:
        for way, right, said in tried(rig, config, lambda way: state.update(WAYS[way].in_words)):
            passed[way] = said or "no message"
            console.print(f"  {'ok    ' if right else 'FAILED'} {WAYS[way].in_words:<34} {said}", markup=False, soft_wrap=True)
            failed += [] if right else [way]
    if failed:
        raise HjcampError(f"rig '{name}': not made safe with a driver that is {', '.join(failed)}")
    console.print(
        f"  {name} passes on a fake driver; its own was not opened: hjcamp rig check plant={rig.plant} rig={name}", markup=False
    )
    return {"schema": "hjcamp.checks/1", "of": "rig", "passed": [{"name": name, "checks": passed}]}


def config_with_motion(rig: type[Rig]) -> dict[str, Any]:
    """Return the configuration of a hundred samples in which the plant's first input is a quarter of its usual size."""
    from hjcamp.configuration.composer import Composer
    from hjcamp.controllers.fit import input_field
    from hjcamp.known_plants import find_plant
    from hjcamp.model.language.field_unit import unit_of_field

    plant = find_plant(rig.plant, f"rig '{rig.name}'")
    name, given = next(iter(plant.given_inputs().items()))
    held = ["controller=given", f"controller.input={name}", "trajectory=hold", f"trajectory.duration={100 * plant.period}"]
    config = Composer().compose([f"plant={rig.plant}", *held, "backend=rig", f"rig={rig.name}"]).config
    unit = unit_of_field(input_field(plant, name), plant.name)
    config["trajectory"][f"angle_{unit.suffix}"] = 0.25 * given.typical * unit.scale
    return config
