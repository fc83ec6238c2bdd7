"""What `hjcamp effects` shows of an effect on this joint: a simulated test without and with it, and its checks."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.errors import HjcampError, UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.model.declare.effect import Effect
    from hjcamp.plants.pump_joint.figures.effect import Columns

LONGEST_S = 15.0  # a test takes well under a second
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


def configured(overrides: list[str]) -> dict[str, Any]:
    """Return the configuration of the test that the picture shows."""
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer, free

    if any(line.startswith("campaign=") for line in overrides):
        raise UsageError("campaign=...: a picture shows one test; choose trajectory=, controller=, payload= ... instead")
    config = Composer().compose([free(line) for line in (*TEST, *overrides)]).config
    check_configuration(config)
    return config


def draw(name: str, config: dict[str, Any], path: Path) -> None:
    """Simulate one test without and with the effect and write the picture."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.plants.pump_joint.figures.effect import draw_effect

    console = make_console()
    without, with_effect = simulated_pair(name, config, console)
    choices = f"{config['controller']['name']}, {config['trajectory']['name']}, payload {config['payload']['name']}"
    draw_effect(path, f"{name}: {choices}", without, with_effect)
    console.print(f"\n  picture  {path}", markup=False, soft_wrap=True)


def simulated_pair(name: str, config: dict[str, Any], console: Console) -> tuple[Columns, Columns]:
    """Simulate one test without and with an effect and return the columns of both."""
    from hjcamp.campaign.execution.compiling import kernels_of, status
    from hjcamp.model.files.time_limit import RunLimit
    from hjcamp.plants.pump_joint.simulation import run_test

    own: dict[str, Any] = {**(config["effects"] or {})}
    given = {**(own.pop(name, None) or {})}
    plain, full = {**config, "effects": own}, {**config, "effects": {**own, name: given}}
    with status(console, kernels_of([plain, full]), "simulating one test without and with the effect"):
        without, _ = run_test(plain, seed=1)
        try:
            with RunLimit(LONGEST_S, f"effect {name}: the test of its picture")():
                with_effect, _ = run_test(full, seed=1)
        except HjcampError as problem:
            raise HjcampError(f"no picture: with {name} at these parameters {problem}") from None
    return without, with_effect


def paint(figure: Any, name: str, overrides: list[str], console: Console) -> None:
    """Fill a figure with that picture of an effect."""
    from hjcamp.plants.pump_joint.figures.effect import SIZE, paint_effect

    figure.set_size_inches(*SIZE)
    paint_effect(figure, name, *simulated_pair(name, configured(overrides), console))


def checks(effect: type[Effect], longest_s: float, console: Console) -> Iterator[tuple[str, str]]:
    """Run the checks on simulated tests of the joint."""
    from hjcamp.campaign.execution.compiling import Kernels, status
    from hjcamp.model.files.time_limit import RunLimit
    from hjcamp.plants.pump_joint import PumpJoint
    from hjcamp.plants.pump_joint.effect_checks import CHECKS, EffectBench, bench_simulator

    watch = RunLimit(longest_s, f"effect {effect.name}: one test of its checks")
    bench = EffectBench(effect, bench_simulator(PumpJoint, (effect,)), PumpJoint.courses(), watch)
    kernels = Kernels({f"the model with {effect.name}": (bench.simulator.source, "follow")})
    for number, (check, passes) in enumerate(CHECKS.items()):
        with status(console, kernels if not number else Kernels({}), f"checking: {check}"):
            found = passes(bench)
        yield check, found
