"""After a fault, where the user said ``--keep-going``: is the rig fit for the next test? Quick, and under all limits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import copysign
from typing import Any

from hjcamp.errors import RigStopped
from hjcamp.plants.pump_joint.rig.check import BACK, FORWARD, Finding, RigCheck, open_check
from hjcamp.plants.pump_joint.rig.left import LeftAt
from hjcamp.plants.pump_joint.rig.limits import COMMAND_PHASE
from hjcamp.plants.pump_joint.rig.silence import RELEASE_PHASE

SETTLING_SAMPLES = 300
STRAY_MM = 0.1


def look_again(config: Mapping[str, Any], left: LeftAt) -> str:
    """Look at a rig that was made safe and bring it back to where a test begins; return what was found.

    At rest: both sensors in their range and quiet, both encoders readable and still. Then the pump goes slowly back to
    its start, the lines must take the preload, small motions of pump and arm must show in both encoders and both lines,
    and the lines are released. Raises ``RigStopped`` where that fails; the outputs end in their safe state either way.
    """
    texts = []
    # The counters go on where the stopped test left them; a virtual rig keeps the joint of that test.
    with open_check(config, None, left) as check:
        for finding in _findings(check):
            if not finding.passed:
                raise RigStopped(f"{finding.name}: {finding.text}")
            texts.append(f"{finding.name}: {finding.text}")
    return "; ".join(texts)


def _findings(check: RigCheck) -> Iterator[Finding]:
    # In the phase of the release neither the reference of a test nor the sum of the pressures is asked for.
    check.out[0] = RELEASE_PHASE
    settle(check)
    yield check.at_rest()
    yield back_to_start(check)
    yield check.preload()
    yield check.pump_direction()
    yield check.arm_direction()
    yield check.go_back()


def settle(check: RigCheck) -> None:
    """Let what was stopped in its motion come to rest."""
    for _ in range(SETTLING_SAMPLES):
        check.sample()


def back_to_start(check: RigCheck) -> Finding:
    """Bring the pump back; while the lines are loaded a silent encoder and a loss of water are noticed on the way."""
    if sum(check.pressures) * 1e-6 > check.limits.limits.pressure_sum_low_mpa:
        check.out[0] = COMMAND_PHASE
    direction = copysign(FORWARD, -check.command) if check.command else BACK
    away = abs(check.travel())
    check.drive(lambda: check.command * direction >= 0.0, direction, away + STRAY_MM)
    check.command = 0.0
    settle(check)
    check.out[0] = RELEASE_PHASE
    text = f"the pump went back by {away:.2f} mm"
    if abs(check.travel()) > STRAY_MM:
        return Finding("pump", False, f"it stands at {check.travel():.2f} mm and should be back at its start")
    return Finding("pump", True, text)
