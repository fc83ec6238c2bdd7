"""Show the effect library, or one effect with a picture; write and test an effect of one's own."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, check_picture, write_answer
from hjcamp.errors import UsageError, counted
from hjcamp.known_plants import DEFAULT, find_plant, plant_called
from hjcamp.model.declare.port import KINDS
from hjcamp.model.files.time_limit import time_limit

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect
    from hjcamp.model.declare.plant import Plant

RUN_S = 15.0  # a test of the checks takes well under a second
USAGE = (
    "hjcamp effects [NAME [OVERRIDE...]] | effects --pages DIR | effects new NAME [--on KIND | --from DIAGNOSIS [--form FORMULA]] | "
    "effects test NAME, each with --plant PLANT"
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("effects")(effects)


def effects(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME [OVERRIDE...] | new NAME | test NAME]",
            help="An effect; none for the catalogue.",
            show_default=False,
        ),
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option("--figure", help="Draw tests without and with the effect into this file (png, svg, pdf)."),
    ] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", hidden=True)] = False,
    plant: Annotated[str, typer.Option(help=f"Which plant's effects; {DEFAULT} if not given.", show_default=False)] = "",
    on: Annotated[str, typer.Option(help="With new: write it for this kind of place, on any plant.", show_default=False)] = "",
    begun: Annotated[
        Path | None,
        typer.Option(
            "--from",
            help="With new: begin with the curve that a diagnosis found (its folder, or its --json).",
            show_default=False,
        ),
    ] = None,
    form: Annotated[
        str,
        typer.Option(help="With --from: write this formula that the diagnosis proposes, not the curve.", show_default=False),
    ] = "",
    pages: Annotated[
        Path | None,
        typer.Option("--pages", help="Write a page for each effect and plant into this folder.", show_default=False),
    ] = None,
    json: AnswerFile = None,
) -> None:
    """Show the effect library, or one effect, with --figure in a picture; write and test an effect of one's own."""
    if on and (words or [])[:1] != ["new"]:
        raise UsageError(f"--on is for a new effect: {USAGE}")
    if begun is not None and ((words or [])[:1] != ["new"] or on or plant):
        raise UsageError(f"--from is for a new effect, and says on which plant: {USAGE}")
    if form and begun is None:
        raise UsageError(f"--form is a formula of a diagnosis: give --from with it: {USAGE}")
    if pages is not None and words:
        raise UsageError(f"--pages writes all effects and plants, and takes no name: {USAGE}")
    check_answer_file(json)
    match words or []:
        case [] if pages is not None:
            write_catalogue(pages)
        case []:
            write_answer(json, show_catalogue(plant))
        case ["new", name]:
            written = write_new(name, plant, on, begun, form)
            write_answer(json, {"schema": "hjcamp.template/1", "name": name, "file": str(written)})
        case ["test", name]:
            write_answer(json, test_effect(name, plant))
        case ["new" | "test", *_]:
            raise UsageError(f"give one name: {USAGE}")
        case [name, *overrides]:
            show_one(name, overrides, plant, figure, no_figure, json)


def show_one(name: str, overrides: Sequence[str], plant: str, figure: Path | None, no_figure: bool, json: Path | None) -> None:
    """Print one effect, and draw tests without and with it where a picture is asked for."""
    own = plant_called(plant or DEFAULT).room_of("effects")
    pictured, asked = is_pictured(name, plant or DEFAULT), bool(figure or overrides) and not no_figure
    if asked and not pictured:
        raise UsageError(f"effect {name}: pictures are of tests of {DEFAULT}; leave out --figure and overrides")
    config = own.configured(overrides) if own and asked else None
    path = figure or Path(f"effect_{name}.png")
    if asked:
        check_picture(path)
    write_answer(json, show_effect(name, plant))
    if own and config is not None:
        own.draw(name, config, path)
    elif pictured and not no_figure:
        print(f"  picture  hjcamp effects {name} --figure {path}")


def write_catalogue(folder: Path) -> None:
    """Write the catalogue as pages."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.catalogue import write_pages

    written = write_pages(folder)
    make_console().print(f"  {counted(len(written), 'page')}  {written[-1]}", markup=False, soft_wrap=True)


def show_catalogue(plant: str = "") -> dict[str, Any]:
    """Print every effect of a plant, and without one those for any plant: where it acts, what it is, its parameters."""
    from rich.table import Table

    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.answers import effect_row
    from hjcamp.effects import effect_files, imposed_files, library_of

    library = library_of(plant or DEFAULT)
    parts = [*library.plant.subsystems, *KINDS]
    generic = {} if plant else {name: effect for name, effect in effect_files().items() if effect.acts_on}
    shown = [(effect.subsystem, name, effect) for name, effect in library.effects.items()]
    others = [(effect.acts_on, name, effect) for name, effect in generic.items()]
    console = make_console()
    for heading, rows in (("subsystem", shown), ("kind of place", others)):
        table = Table(box=None, header_style="bold", pad_edge=False)
        for column in (heading, "effect", "what the published model leaves out", "parameters"):
            table.add_column(column, no_wrap=column == "effect")
        for part, name, effect in sorted(rows, key=lambda row: parts.index(row[0]) if row[0] in parts else len(parts)):
            table.add_row(part, name, effect.sentence(), ", ".join(effect.parameters))
        if rows:
            console.print(table)
        said = f"{counted(len(rows), 'effect')}; one of them: hjcamp effects NAME"
        if rows is shown:
            said += f" --plant {plant}; what does not fit: hjcamp plants {plant}" if plant else ""
        else:
            said = f"{len(rows)} for any plant with such a place; which fit: hjcamp plants PLANT"
        if rows or rows is shown:
            console.print(f"  {said}", style="dim", markup=False, soft_wrap=True)
    more = ", ".join(imposed_files())
    console.print(f"  put on a rig on purpose, and no candidate: {more}", style="dim", markup=False, soft_wrap=True)
    told = {
        "effects": [effect_row(one) for _, _, one in shown],
        "for_any_plant": [effect_row(one) for _, _, one in others],
    }
    return {"schema": "hjcamp.effects/1", "plant": library.plant.name, **told}


def is_pictured(name: str, plant: str) -> bool:
    """Return whether a test of the plant can be drawn with that effect; an unknown name is shown as such later."""
    from hjcamp.effects import effect_files, library_of

    if "effects" not in plant_called(plant).rooms:
        return False
    return name in library_of(plant, imposed=True).effects or name not in effect_files()


def shown_effect(name: str, plant: str) -> type[Effect]:
    """Return the effect as the plant has it; where no plant is asked for and it has none, as its file holds it."""
    from hjcamp.effects import effect_files, library_of

    library = library_of(plant or DEFAULT, imposed=True)
    files = {} if plant else effect_files()
    if name not in library.effects and name in files and files[name].acts_on:
        return files[name]
    return library.find(name)


def show_effect(name: str, plant: str = "") -> dict[str, Any]:
    """Print one effect: what it is, equation, validity, source, parameters, and on what it acts."""
    from rich.table import Table

    from hjcamp.campaign.execution.console import bold, make_console
    from hjcamp.commands.shared.answers import effect_row

    effect = shown_effect(name, plant)
    console = make_console()
    console.print(bold(name, f"  ({effect.subsystem or effect.acts_on})"))
    text = inspect.cleandoc(effect.__doc__ or "").replace(".. math:: ", "    ")
    for line in text.splitlines():
        console.print(f"  {line}" if line.strip() else "", markup=False)
    place = f" of each {effect.acts_on}" if effect.acts_on else ""
    console.print(f"\n  acts on  {', '.join(effect.terms)}{place}", markup=False)
    for state in effect.states.values():
        console.print(f"  own state  {state.name} [{state.unit}]  {state.text}", markup=False)
    table = Table(box=None, header_style="bold")
    for column in ("parameter", "unit", "default", "bounds", "prior", "absent at", "meaning"):
        table.add_column(column)
    for parameter in effect.parameters.values():
        low, high = parameter.bounds
        absent = "" if parameter.off is None else f"{parameter.off:g}"
        bounds = f"{low:g} ... {high:g}"
        table.add_row(parameter.name, parameter.unit, f"{parameter.default:g}", bounds, parameter.prior, absent, parameter.text)
    console.print(table)
    if effect.acts_on:
        console.print(
            "  units are names of the place, numbers multiples of what these usually are; "
            f"in SI: hjcamp effects {name} --plant PLANT",
            style="dim",
            markup=False,
            soft_wrap=True,
        )
    return {"schema": "hjcamp.effect/1", "documentation": text, **effect_row(effect)}


def write_new(name: str, plant: str = "", on: str = "", begun: Path | None = None, form: str = "") -> Path:
    """Write the template of an effect into ./effects: in the names of the usual plant, for a kind of place, or from a diagnosis."""
    from hjcamp.campaign.execution.console import make_console

    if begun is not None:
        from hjcamp.commands.shared.effect_from import write_from_diagnosis
        from hjcamp.effects import effect_files, imposed_files, load_effects

        taken = {*effect_files([]), *imposed_files(), *load_effects([])}
        path, plant, proposed = write_from_diagnosis(name, begun, sorted(taken), form)
        plant = "" if plant == DEFAULT else plant
    else:
        path, proposed = new_effect_file(name, plant, on), []
    console = make_console()
    console.print(f"  written  {path}", markup=False)
    for number, line in enumerate(proposed):
        console.print(f"  {'' if number else 'formula':<7}  {line}", markup=False, soft_wrap=True)
    where = f" --plant {plant}" if plant else " --plant PLANT" if on else ""
    console.print(f"  next     hjcamp effects test {name}{where}", markup=False)
    return path


def new_effect_file(name: str, plant: str, on: str) -> Path:
    """Write that template and return its path."""
    from hjcamp.effects import effect_files, imposed_files, load_effects
    from hjcamp.effects._generic_template import write_generic
    from hjcamp.effects._template import write_template

    folder, taken = Path("effects"), {*effect_files([]), *imposed_files(), *load_effects([])}
    if on or plant not in ("", DEFAULT):
        return write_generic(name, folder, find_plant(plant) if plant else None, on, taken)
    return write_template(name, folder, find_plant(DEFAULT, folders=[]), taken)


def test_effect(name: str, plant: str = "") -> dict[str, Any]:
    """Run the checks that every effect of the library passes on one effect, at each of its places."""
    from hjcamp.campaign.execution.console import bold, make_console
    from hjcamp.effects import library_of
    from hjcamp.model.language.effect_units import check_units

    library = library_of(plant or DEFAULT)
    own = library.plant.room_of("effects")
    console = make_console()
    passed: list[dict[str, Any]] = []
    for one in library.names.get(name, (name,)):
        effect = library.find(one)
        check_units(effect, library.plant)
        checks = own.checks(effect, RUN_S, console) if own else place_checks(effect, library.plant)
        told: dict[str, str] = {}
        for check, answer in checks:
            told[check] = answer
            console.print(f"  {check:<26} {answer}", markup=False)
        use = f"; use it: hjcamp run campaign=controllers '+effects.{one}={{}}'" if own else ""
        passed.append({"name": one, "checks": told})
        console.print(bold(one, f" passes{use}"))
    return {"schema": "hjcamp.checks/1", "of": "effect", "passed": passed}


def place_checks(effect: type[Effect], plant: type[Plant]) -> Iterator[tuple[str, str]]:
    """Run the checks that need no compiled model."""
    from hjcamp.model.checks.place_checks import PLACE_CHECKS, PlaceBench

    bench = PlaceBench(effect, plant)
    for check, passes in PLACE_CHECKS.items():
        with time_limit(4.0 * RUN_S, f"effect {effect.name}: one of its checks"):
            answer = passes(bench)
        yield check, answer
