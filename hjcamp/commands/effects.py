"""Show the effect library, or one effect with a picture; write and test an effect of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from hjcamp.errors import HjcampError, UsageError

RUN_S = 15.0  # a test of the checks takes well under a second
USAGE = "hjcamp effects [NAME [OVERRIDE...]] | effects new NAME | effects test NAME"
# Fast and slow moves, reversals and rests at a high preload with dither: every effect has its moment. Open loop, for in
# closed loop one slip that comes earlier changes all that follow. The draws of the rig are left out.
TEST = (
    "controller=open_loop",
    "controller.dither.amplitude_v=1.2",
    "trajectory=segments",
    "trajectory.segments=[{rest: 0.2}, {to_deg: 90, in: 0.4}, {rest: 0.5}, {to_deg: -50, in: 0.6}, {rest: 0.5}, "
    "{to_deg: 0, in: 1.4, law: linear}, {rest: 0.4}]",
    "procedure.preload_mpa=0.6",
    "rig.scatter.friction_between=0",
    "rig.scatter.friction_within=0",
    "rig.scatter.initial_pressure_mpa=0",
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
        typer.Option("--figure", help="Where the picture goes (png, svg, pdf); effect_NAME.png if not given."),
    ] = None,
    no_figure: Annotated[bool, typer.Option("--no-figure", help="No picture.")] = False,
) -> None:
    """Show the effect library, or one effect with a picture; write and test an effect of one's own."""
    match words or []:
        case []:
            show_catalogue()
        case ["new", name]:
            write_new(name)
        case ["test", name]:
            test_effect(name)
        case ["new" | "test", *_]:
            raise UsageError(f"give one name: {USAGE}")
        case [name, *overrides]:
            config = None if no_figure else configured(overrides)
            from hjcamp.commands._session import check_picture

            path = figure or Path(f"effect_{name}.png")
            check_picture(path)
            show_effect(name)
            if config is not None:
                draw(name, config, path)


def show_catalogue() -> None:
    """Print every effect: subsystem, what it is, its parameters."""
    from rich.table import Table

    from hjcamp.campaign.console import make_console
    from hjcamp.effects import load_effects
    from hjcamp.plants.pump_joint import PumpJoint

    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("subsystem", "effect", "what the published model leaves out", "parameters"):
        table.add_column(column, no_wrap=column == "effect")
    library = load_effects()
    for name, effect in sorted(library.items(), key=lambda item: PumpJoint.subsystems.index(item[1].subsystem)):
        table.add_row(effect.subsystem, name, effect.sentence(), ", ".join(effect.parameters))
    console = make_console()
    console.print(table)
    console.print(f"  {len(library)} effects; one of them: hjcamp effects NAME", style="dim", markup=False)


def show_effect(name: str) -> None:
    """Print one effect: what it is, equation, validity, source, parameters, and on what it acts."""
    import inspect

    from rich.table import Table

    from hjcamp.campaign.console import make_console
    from hjcamp.effects import find_effect

    effect = find_effect(name)
    console = make_console()
    console.print(f"[bold]{name}[/bold]  ({effect.subsystem})")
    text = inspect.cleandoc(effect.__doc__ or "").replace(".. math:: ", "    ")
    for line in text.splitlines():
        console.print(f"  {line}" if line.strip() else "", markup=False)
    console.print(f"\n  acts on  {', '.join(effect.terms)}", markup=False)
    for state in effect.states.values():
        console.print(f"  own state  {state.name} [{state.unit}]  {state.text}", markup=False)
    table = Table(box=None, header_style="bold")
    for column in ("parameter", "unit", "default", "bounds", "prior", "absent at", "meaning"):
        table.add_column(column)
    for parameter in effect.parameters.values():
        low, high = parameter.bounds
        absent = "" if parameter.off is None else f"{parameter.off:g}"
        bounds = f"{low:g} ... {high:g}"
        table.add_row(
            parameter.name, parameter.unit, f"{parameter.default:g}", bounds, parameter.prior, absent, parameter.text
        )
    console.print(table)


def configured(overrides: list[str]) -> dict[str, Any]:
    """Return the configuration of the test that the picture shows."""
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer, free

    if any(line.startswith("campaign=") for line in overrides):
        raise UsageError(
            "campaign=...: a picture shows one test; choose trajectory=, controller=, payload= ... instead"
        )
    config = Composer().compose([free(line) for line in (*TEST, *overrides)]).config
    check_configuration(config)
    return config


def draw(name: str, config: dict[str, Any], path: Path) -> None:
    """Simulate one test without and with the effect and write the picture."""
    from hjcamp.backends.simulation import run_test
    from hjcamp.campaign.compiling import kernels_of, status
    from hjcamp.campaign.console import make_console
    from hjcamp.model.time_limit import RunLimit
    from hjcamp.report.effect_figure import draw_effect

    console = make_console()
    own: dict[str, Any] = {**(config["effects"] or {})}
    given = {**(own.pop(name, None) or {})}
    plain, full = {**config, "effects": own}, {**config, "effects": {**own, name: given}}
    with status(console, kernels_of([plain, full]), "simulating one test without and with the effect"):
        without, _ = run_test(plain, seed=1)
        try:
            with RunLimit(RUN_S, f"effect {name}: the test of its picture")():
                with_effect, _ = run_test(full, seed=1)
        except HjcampError as problem:
            raise HjcampError(f"no picture: with {name} at these parameters {problem}") from None
    choices = f"{config['controller']['name']}, {config['trajectory']['name']}, payload {config['payload']['name']}"
    draw_effect(path, f"{name}: {choices}", without, with_effect)
    console.print(f"\n  picture  {path}", markup=False, soft_wrap=True)


def write_new(name: str) -> None:
    """Write the template of an effect into ./effects."""
    from hjcamp.campaign.console import make_console
    from hjcamp.effects import load_effects
    from hjcamp.effects._template import write_template
    from hjcamp.plants.pump_joint import PumpJoint

    path = write_template(name, Path("effects"), PumpJoint, load_effects([]))
    console = make_console()
    console.print(f"  written  {path}", markup=False)
    console.print(f"  next     hjcamp effects test {name}", markup=False)


def test_effect(name: str) -> None:
    """Run the checks that every effect of the library passes on one effect."""
    from hjcamp.campaign.compiling import Kernels, status
    from hjcamp.campaign.console import make_console
    from hjcamp.effects import find_effect
    from hjcamp.model.effect_checks import CHECKS, EffectBench, bench_simulator
    from hjcamp.model.effect_units import check_units
    from hjcamp.model.time_limit import RunLimit
    from hjcamp.plants.pump_joint import PumpJoint
    from hjcamp.plants.pump_joint_menu import pump_courses

    effect = find_effect(name)
    check_units(effect, PumpJoint)
    watch = RunLimit(RUN_S, f"effect {name}: one test of its checks")
    bench = EffectBench(effect, bench_simulator(PumpJoint, (effect,)), pump_courses(), watch)
    console = make_console()
    kernels = Kernels({f"the model with {name}": (bench.simulator.source, "follow")})
    for number, (check, passes) in enumerate(CHECKS.items()):
        with status(console, kernels if not number else Kernels({}), f"checking: {check}"):
            found = passes(bench)
        console.print(f"  {check:<26} {found}", markup=False)
    console.print(f"[bold]{name}[/bold] passes; use it: hjcamp run campaign=controllers '+effects.{name}={{}}'")
