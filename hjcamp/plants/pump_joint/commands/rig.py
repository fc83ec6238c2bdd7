"""The rig: serve a virtual one, check a real one, see who uses it: hjcamp rig serve, check, unlock."""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from dataclasses import asdict
from typing import Annotated, Any

import typer

from hjcamp.commands import PLAIN
from hjcamp.commands.shared.session import AnswerFile
from hjcamp.errors import HjcampError

COUNT_DOWN_S = 3
Overrides = Annotated[list[str] | None, typer.Argument(metavar="OVERRIDES", help="As of hjcamp run: rig=NAME ...")]


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
        list[str] | None, typer.Argument(metavar="EFFECTS", help="Hidden effects: effects.leakage.conductance=1e-15")
    ] = None,
    address: Annotated[str, typer.Option(help="HOST:PORT to serve on.")] = "localhost:31763",
    fault: Annotated[list[str] | None, typer.Option(help="KIND@SAMPLE or KIND@SAMPLE#TEST; more than one is fine.")] = None,
    anybody: Annotated[bool, typer.Option("--anybody", help="Serve on an address that other computers reach.")] = False,
    real_time: Annotated[
        bool, typer.Option("--real-time", help="Time passes by itself, as on a real rig; otherwise a read is a sample.")
    ] = False,
    rate: Annotated[
        float | None, typer.Option(help="Seconds of the rig for each of the clock, 0.01 to 1, with --real-time.")
    ] = None,
) -> None:
    """Serve a virtual rig on the vendor's protocol, in lockstep virtual time or in real time, until Ctrl-C."""
    from hjcamp.configuration.composer import Composer, free
    from hjcamp.effects import chosen_effects
    from hjcamp.errors import UsageError
    from hjcamp.plants.pump_joint.virtual_rig.faults import parse_fault
    from hjcamp.plants.pump_joint.virtual_rig.server import check_address, client_address, is_local, start_server

    check_address(address, anybody)
    if rate is not None and not (real_time and 0.01 <= rate <= 1.0):
        raise UsageError(f"--rate {rate:g}: only with --real-time, and from 0.01 to 1")
    faults = [parse_fault(text) for text in fault or []]
    lines = [free(line.lstrip("+")) for line in overrides or []]
    if wrong := [line for line in lines if not line.lstrip("+").startswith("effects.")]:
        raise UsageError(f"'{wrong[0]}': only effects can be hidden in the rig; the client says what hardware is on it")
    hidden = Composer().compose(lines).config.get("effects") or {}
    chosen_effects(hidden)
    server, port, device = start_server(address, faults, hidden, (rate or 1.0) if real_time else None, _say)
    if not is_local(address):
        print(
            f"hjcamp: WARNING: listening on {address.rpartition(':')[0]}:{port}, where other computers can reach it: "
            "whoever does can run tests on it, without a password",
            file=sys.stderr,
        )
    where = client_address(address, port)
    pace = f", in real time at {rate or 1.0:g} of the clock" if real_time else ""
    _say(f"a virtual rig is served at {where}{pace}; Ctrl-C ends it")
    _say(f"use it with: backend=nidaqmx rig=virtual rig.connection={{kind:address,address:'{where}'}}")
    try:
        server.wait_for_termination()
    finally:
        server.stop(0.5).wait()
        device.close()


def _say(text: str) -> None:
    # Nobody need read it: a terminal that is closed must not stop the rig.
    with suppress(OSError):
        print(text, flush=True)


def check(
    overrides: Overrides = None,
    yes: Annotated[bool, typer.Option("--yes", help="Confirm the motion without looking.")] = False,
    json: AnswerFile = None,
) -> None:
    """Check wiring, noise, preload and directions with small motions; a rig must pass before it runs a campaign."""
    from hjcamp.backends import before_moving, compile_ahead
    from hjcamp.campaign.execution.compiling import kernels_of, status
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.session import check_answer_file, write_answer
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer, free
    from hjcamp.plants.pump_joint.rig.check import Finding, check_rig

    check_answer_file(json)
    config = Composer().compose([free(line) for line in overrides or []] + ["backend=nidaqmx"]).config
    check_configuration(config)

    findings: list[dict[str, Any]] = []

    def say(finding: Finding) -> None:
        findings.append(asdict(finding))
        print(f"{'ok    ' if finding.passed else 'FAILED'} {finding.name:<8} {finding.text}", flush=True)

    def ask(question: str) -> bool:
        return yes or typer.confirm(question)

    def before() -> None:
        with status(make_console(), kernels_of([config]), "looking for the rig"):
            compile_ahead(config)
        if yes:
            return
        print(f"The rig '{name}' will move: preload, the pump by a few mm, the arm by a few degrees.")
        if not typer.confirm("Is everybody clear of it?"):
            raise HjcampError("not checked: nothing was moved")
        for left in range(COUNT_DOWN_S, 0, -1):
            print(f"       moves in {left} s", flush=True)
            time.sleep(1.0)

    name = config["rig"]["name"]
    for text in before_moving(config):
        print(f"note   {text}")
    passed = check_rig(config, ask, say, before=before, announce=lambda words: print(f"next   {words}", flush=True))
    write_answer(json, {"schema": "hjcamp.rig_check/1", "rig": name, "passed": passed, "findings": findings})
    if not passed:
        raise HjcampError(f"rig '{name}' has not passed its check; the outputs are safe")
    print(f"rig '{name}' has passed; this holds until its wiring or limits are changed")


def unlock(json: AnswerFile = None) -> None:
    """Say who holds each rig of this computer. A lock ends with its process, so there is nothing to remove."""
    from hjcamp.commands.shared.session import check_answer_file, write_answer
    from hjcamp.plants.pump_joint.rig.lock import describe, is_free, lock_folder, read_holder

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
