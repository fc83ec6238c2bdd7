"""The rig of this joint on the command line: serve a virtual one, check one before it moves."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

from hjcamp.errors import UsageError


def serve(
    overrides: Sequence[str], address: str, fault: Sequence[str], anybody: bool, rate: float | None, say: Callable[[str], None]
) -> None:
    """Serve a virtual rig on the vendor's protocol until Ctrl-C; ``rate`` None: in lockstep."""
    from hjcamp.configuration.composer import Composer, free
    from hjcamp.effects import chosen_effects
    from hjcamp.plants.pump_joint.virtual_rig.faults import parse_fault
    from hjcamp.plants.pump_joint.virtual_rig.server import check_address, client_address, is_local, start_server

    check_address(address, anybody)
    faults = [parse_fault(text) for text in fault]
    lines = [free(line.lstrip("+")) for line in overrides]
    if wrong := [line for line in lines if not line.lstrip("+").startswith("effects.")]:
        raise UsageError(f"'{wrong[0]}': only effects can be hidden in the rig; the client says what hardware is on it")
    hidden = Composer().compose(lines).config.get("effects") or {}
    chosen_effects(hidden)
    server, port, device = start_server(address, faults, hidden, rate, say)
    if not is_local(address):
        print(
            f"hjcamp: WARNING: listening on {address.rpartition(':')[0]}:{port}, where other computers can reach it: "
            "whoever does can run tests on it, without a password",
            file=sys.stderr,
        )
    where = client_address(address, port)
    pace = f", in real time at {rate:g} of the clock" if rate is not None else ""
    say(f"a virtual rig is served at {where}{pace}; Ctrl-C ends it")
    say(f"use it with: backend=nidaqmx rig=virtual rig.connection={{kind:address,address:'{where}'}}")
    try:
        server.wait_for_termination()
    finally:
        server.stop(0.5).wait()
        device.close()


def check(
    overrides: Sequence[str], ask: Callable[[str], bool], ready: Callable[[str, str], None], show: Callable[[Any], None]
) -> dict[str, Any]:
    """Check the rig of a configuration; ``ready`` is asked last before it moves. Returns the answer for programs."""
    from hjcamp.backends import before_moving, compile_ahead
    from hjcamp.campaign.execution.compiling import kernels_of, status
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.configuration.check import check_configuration
    from hjcamp.configuration.composer import Composer, free
    from hjcamp.plants.pump_joint.rig.check import Finding, check_rig

    config = Composer().compose([free(line) for line in overrides] + ["backend=nidaqmx"]).config
    check_configuration(config)
    findings: list[dict[str, Any]] = []

    def say(finding: Finding) -> None:
        findings.append(asdict(finding))
        show(finding)

    def before() -> None:
        with status(make_console(), kernels_of([config]), "looking for the rig"):
            compile_ahead(config)
        ready(name, "preload, the pump by a few mm, the arm by a few degrees")

    name = config["rig"]["name"]
    for text in before_moving(config):
        print(f"note   {text}")
    passed = check_rig(config, ask, say, before=before, announce=lambda words: print(f"next   {words}", flush=True))
    return {"schema": "hjcamp.rig_check/1", "rig": name, "passed": passed, "findings": findings}
