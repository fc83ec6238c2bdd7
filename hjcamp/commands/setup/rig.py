"""The rig: serve a virtual one, check a real one, see who uses it: hjcamp rig serve, check, unlock."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated, Any

import typer

from hjcamp.commands import PLAIN
from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import HjcampError, UsageError

COUNT_DOWN_S = 3
ADDRESS = "localhost:31763"
Overrides = Annotated[list[str] | None, typer.Argument(metavar="OVERRIDES", help="As of hjcamp run: plant=NAME rig=NAME ...")]


def register(app: typer.Typer) -> None:
    """Add the commands."""
    group = typer.Typer(
        name="rig",
        help="Serve a virtual rig, check a real one, see who uses it.",
        no_args_is_help=True,
        **PLAIN,
    )
    group.command("serve")(serve)
    group.command("check")(check)
    group.command("unlock")(unlock)
    app.add_typer(group)


def serve(
    overrides: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="OVERRIDES",
            help="plant=NAME parameters.NAME=VALUE ...; of the joint hidden effects alone: effects.leakage.conductance=1e-15",
        ),
    ] = None,
    hide: Annotated[
        list[str] | None, typer.Option(help="EFFECT, or EFFECT.PARAMETER=VALUE (SI); more than one is fine.")
    ] = None,
    seed: Annotated[int, typer.Option(help="What is hidden without a value is drawn from it.")] = 1,
    pty: Annotated[bool, typer.Option("--pty", help="Over a pseudo-terminal, as on a serial port; else a socket.")] = False,
    watchdog_ms: Annotated[float, typer.Option(help="After how long without a write the outputs are made safe.")] = 50.0,
    address: Annotated[str, typer.Option(help="HOST:PORT to serve on; of another plant than the joint its port.")] = ADDRESS,
    fault: Annotated[list[str] | None, typer.Option(help="KIND@SAMPLE or KIND@SAMPLE#TEST; more than one is fine.")] = None,
    anybody: Annotated[
        bool, typer.Option("--anybody", help="Serve the joint on an address that other computers reach.")
    ] = False,
    real_time: Annotated[
        bool, typer.Option("--real-time", help="Time passes by itself, as on a real rig; otherwise a read is a sample.")
    ] = False,
    rate: Annotated[
        float | None, typer.Option(help="Seconds of the rig for each of the clock, 0.01 to 1, with --real-time.")
    ] = None,
) -> None:
    """Serve a virtual rig, in lockstep virtual time or in real time, until Ctrl-C.

    The joint's speaks the vendor's protocol; that of another plant the text protocol of a serial line (docs/rig_protocol.md), with
    effects that its model does not have, to programs of this user alone: hjcamp run backend=rig rig=virtual plant=NAME.
    """
    from hjcamp.known_plants import plant_called

    if rate is not None and not (real_time and 0.01 <= rate <= 1.0):
        raise UsageError(f"--rate {rate:g}: only with --real-time, and from 0.01 to 1")
    pace = (rate or 1.0) if real_time else None
    plant = plant_called(_plant_in(overrides or []), "plant")
    own = plant.room_of("rig")
    if own is not None:
        if hide or pty:
            raise UsageError(
                f"plant {plant.name}: say what is hidden as effects.NAME.PARAMETER=VALUE, without --hide and --pty"
            )
        own.serve(overrides or [], address, fault or [], anybody, pace, _say)
        return
    if anybody:
        raise UsageError(f"plant {plant.name}: a virtual rig is served to this user alone; leave --anybody out")
    _serve_plant(overrides or [], hide or [], seed, fault or [], pace, watchdog_ms, pty, address)


def _serve_plant(
    overrides: Sequence[str],
    hide: Sequence[str],
    seed: int,
    fault: Sequence[str],
    rate: float | None,
    watchdog_ms: float,
    pty: bool,
    address: str,
) -> None:
    from hjcamp.backends.virtual_rig.device import VirtualDevice
    from hjcamp.backends.virtual_rig.faults import parse_fault
    from hjcamp.backends.virtual_rig.hidden import hidden_config, hidden_words
    from hjcamp.backends.virtual_rig.server import Served, new_token, port_of, ticket
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer, free

    if not 1.0 <= watchdog_ms <= 60_000.0:
        raise UsageError(f"--watchdog-ms {watchdog_ms:g}: from 1 to 60000")
    faults = [parse_fault(text) for text in fault]
    config = Composer().compose([free(line) for line in overrides]).config
    config, hidden = hidden_config(config, hide, seed)
    check_configuration(config)
    device = VirtualDevice(config, faults, rate, watchdog_ms * 1e-3, new_token(), report=_say)
    served = Served(device, pty, 0 if address == ADDRESS else port_of(address))
    name = device.plant.name
    try:
        with ticket(served):
            pace = f", in real time at {rate:g} of the clock" if rate is not None else ""
            _say(f"a virtual rig of plant {name} is served at {served.port}{pace}; Ctrl-C ends it")
            _say(f"use it with: hjcamp run plant={name} backend=rig rig=virtual ...")
            with suppress(KeyboardInterrupt):
                while True:
                    time.sleep(3600.0)
    finally:
        served.close()
        for text in hidden_words(device.plant, hidden):
            _say(f"hidden   {text}")


def _plant_in(overrides: Sequence[str]) -> str:
    from hjcamp.known_plants import DEFAULT

    return next((line.partition("=")[2] for line in overrides if line.startswith("plant=")), DEFAULT)


def _say(text: str) -> None:
    # Nobody need read it: a terminal that is closed must not stop the rig.
    with suppress(OSError):
        print(text, flush=True)


def check(
    overrides: Overrides = None,
    yes: Annotated[bool, typer.Option("--yes", help="Confirm the motion without looking.")] = False,
    json: AnswerFile = None,
) -> None:
    """Check wiring, noise and directions with small motions; a rig must pass before it runs a campaign."""
    from hjcamp.known_plants import plant_called

    check_answer_file(json)

    def show(finding: Any) -> None:
        print(f"{'ok    ' if finding.passed else 'FAILED'} {finding.name:<8} {finding.text}", flush=True)

    def ask(question: str) -> bool:
        return yes or typer.confirm(question)

    def ready(name: str, motion: str) -> None:
        if yes:
            return
        print(f"The rig '{name}' will move: {motion}.")
        if not typer.confirm("Is everybody clear of it?"):
            raise HjcampError("not checked: nothing was moved")
        for left in range(COUNT_DOWN_S, 0, -1):
            print(f"       moves in {left} s", flush=True)
            time.sleep(1.0)

    own = plant_called(_plant_in(overrides or []), "plant").room_of("rig")
    answer = own.check(overrides or [], ask, ready, show) if own is not None else check_plant(overrides or [], ready, show)
    write_answer(json, answer)
    name = answer["rig"]
    if not answer["passed"]:
        raise HjcampError(f"rig '{name}' has not passed its check; the outputs are safe")
    print(f"rig '{name}' has passed; this holds until its wiring or limits are changed")


def check_plant(overrides: Sequence[str], ready: Any, show: Any) -> dict[str, Any]:
    """Check the rig of another plant than the joint; returns the answer for programs."""
    from dataclasses import asdict

    from hjcamp.backends import before_moving
    from hjcamp.backends.rig.any_plant.check import Finding, check_rig
    from hjcamp.campaign.execution.compiling import kernels_of, status
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer, free

    config = Composer().compose([free(line) for line in overrides] + ["backend=rig"]).config
    check_configuration(config)
    name, found = str(config["rig"]["name"]), []

    def say(finding: Finding) -> None:
        found.append(asdict(finding))
        show(finding)

    def before() -> None:
        with status(make_console(), kernels_of([config]), "compiling"):
            pass
        ready(name, "each input with a nudge=... goes there for a moment")

    for text in before_moving(config):
        print(f"note   {text}")
    passed = check_rig(config, say, before=before, announce=lambda words: print(f"next   {words}", flush=True))
    return {"schema": "hjcamp.rig_check/1", "rig": name, "passed": passed, "findings": found}


def unlock(json: AnswerFile = None) -> None:
    """Say who holds each rig of this computer. A lock ends with its process, so there is nothing to remove."""
    from hjcamp.backends.rig.lock import describe, is_free, lock_folder, read_holder

    check_answer_file(json)
    held: list[dict[str, Any]] = []
    rigs: list[dict[str, Any]] = []
    for path in sorted(lock_folder().glob("*.lock")):
        holder = read_holder(path)
        rig = str(holder.get("rig", path.stem))
        rigs.append({"rig": rig, "in_use": not is_free(path), "holder": describe(holder)})
        if is_free(path):
            print(f"{rig}: free (last used by {describe(holder)})")
        else:
            held.append(holder)
            print(f"{rig}: in use by {describe(holder)}")
            print(f"  a lock ends with its process; to end that one safely: kill {holder.get('process', 'PROCESS')}")
    if not held:
        print("no rig is in use")
    write_answer(json, {"schema": "hjcamp.rigs/1", "rigs": rigs})
