"""Faults of an axis on the serial protocol over a pseudo-terminal: how each is made, and the row that it gives."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.backends.rig.any_plant.backend import run_on
from hjcamp.backends.virtual_rig.clients import served
from hjcamp.backends.virtual_rig.device import VirtualDevice
from hjcamp.backends.virtual_rig.faults import Fault
from hjcamp.backends.virtual_rig.server import Served, ticket
from hjcamp.errors import RigStopped

#: 30 samples of rest, 80 at 1 V, 40 of rest.
TEST = (
    "plant=axis1", "controller=given", "trajectory=hold", "trajectory.angle_deg=0", "+trajectory.angle_v=1", "trajectory.duration=0.08",
    "procedure.rest_ms=30", "procedure.after_ms=40", "backend=rig", "rig=virtual",
)  # fmt: skip
WHEN = {"rest": 15, "command": 70, "after": 130}
WATCHDOG = 50  # samples
RATE = 0.1
# Of a call that gets no answer; where one comes it may be late on a busy computer, and that is not what is looked at.
DEADLINE_S, PATIENCE_S = 0.5, 30.0
UNANSWERED = ("late", "silent", "refuses")
#: A row is made again, so often at most, where the client was too late for the watchdog before the fault came.
TRIES = 5


@dataclass(frozen=True)
class Case:
    """A fault of the device, or a signal to the client; in ``real`` time its watchdog is what makes the outputs safe."""

    name: str
    kind: str
    says: str
    real: bool = False
    signal: int = 0
    late: int = 0


CASES = (
    Case("late", "late", "THE OUTPUTS COULD NOT BE WRITTEN", real=True),
    Case("10 samples missed", "late_samples", "10 samples were missed at once", late=10),
    Case("silent", "silent", "THE OUTPUTS COULD NOT BE WRITTEN", real=True),
    Case("NaN", "nan", "position_m is lost: it reads nan"),
    Case("wrong length", "short", "read() gave 0 values; 1 are needed"),
    Case("wrong check sum", "garbled", "read() failed: BadLine: no message"),
    Case("refuses", "refuses", "the device says: sensor supply lost", real=True),
    Case("unplugged", "gone", "THE OUTPUTS COULD NOT BE WRITTEN", real=True),
    Case("client killed (SIGKILL)", "", "", real=True, signal=signal.SIGKILL),
    Case("client stopped (SIGSTOP)", "", "the rig was made safe", real=True, signal=signal.SIGSTOP),
)
CLIENT = """
import json, sys
from hjcamp.backends.rig.any_plant.backend import run_test
from hjcamp.errors import HjcampError
from hjcamp.rigs.rig import Rig
Rig.missed_at_once = Rig.missed_in_all = 10**6
try:
    run_test(json.load(open(sys.argv[1])), 1)
except HjcampError as error:
    print(error)
    sys.exit(error.exit_code)
"""


@dataclass(frozen=True)
class Row:
    """What a fault did: after how many samples the outputs were safe, counted from the fault or the last write; code; message."""

    case: Case
    when: str
    samples: int
    code: int
    message: str

    @property
    def most(self) -> int:
        """The stated time in samples: 2 once the loop sees the fault, the watchdog's where the device is not reached."""
        return WATCHDOG + 1 if self.case.real else 2 + self.case.late

    def line(self) -> str:
        """The row as the page has it, without what differs from run to run."""
        safe = f"safe within {self.most} samples" if self.samples <= self.most else f"SAFE ONLY AFTER {self.samples} SAMPLES"
        return f"| {self.case.name} | {self.when} | {safe} | {self.code} | {self.case.says or '-'} |"


def make_row(case: Case, when: str, config: Mapping[str, Any], folder: Path) -> Row:
    """Make one test with the fault, and look at the device's own record."""
    for _ in range(TRIES):
        row, disturbed = _made_row(case, when, config, folder)
        if not disturbed:
            break
    return row


def _made_row(case: Case, when: str, config: Mapping[str, Any], folder: Path) -> tuple[Row, bool]:
    """Return a row, and whether the watchdog tripped before the fault came."""
    at = WHEN[when]
    faults = [Fault(case.kind, at)] if case.kind else []
    device = VirtualDevice(config, faults, RATE if case.real else None, WATCHDOG * 1e-3, "secret")
    line = Served(device, pty=True)
    try:
        with ticket(line):
            code, message = _signalled(case, at, config, device, folder) if case.signal else _run(case, config)
        until = time.monotonic() + 5.0
        while device.outputs != device.safe and time.monotonic() < until:
            time.sleep(0.01)
        disturbed = any(there < at for _, there in device.trips)
        return Row(case, when, _samples_until_safe(device, at), code, message), disturbed
    finally:
        line.close()


def _run(case: Case, config: Mapping[str, Any]) -> tuple[int, str]:
    rig: Any = served(config)
    type(rig).deadline_s = DEADLINE_S if case.kind in UNANSWERED else PATIENCE_S
    if not case.late:  # a busy computer misses samples, and that is not what is looked at
        type(rig).missed_at_once = type(rig).missed_in_all = 10**6
    try:
        run_on(rig, config, 1)
    except RigStopped as error:
        return error.exit_code, str(error)
    return 0, ""


def _signalled(case: Case, at: int, config: Mapping[str, Any], device: VirtualDevice, folder: Path) -> tuple[int, str]:
    file = folder / "config.json"
    file.write_text(json.dumps(config))
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    client = subprocess.Popen([sys.executable, "-c", CLIENT, str(file)], stdout=subprocess.PIPE, text=True, env=environment)
    until = time.monotonic() + 60.0
    while not (device.tests > 0 and device.last_write is not None and device.sample >= at) and time.monotonic() < until:
        if device.trips:
            break  # too late for the watchdog: the row is made again
        time.sleep(0.002)
    client.send_signal(case.signal)
    if case.signal == signal.SIGSTOP:
        time.sleep(2.5 * WATCHDOG * 1e-3 / RATE)
        client.send_signal(signal.SIGCONT)
    out, _ = client.communicate(timeout=60.0)
    return client.returncode, out


def _samples_until_safe(device: VirtualDevice, at: int) -> int:
    """Samples from the fault (from the last write, where the watchdog was first) to safe outputs; very many where they never were."""
    if device.outputs != device.safe:
        return 10**6
    if device.trips:
        return max(there - last for last, there in device.trips)
    last = device.written[-1][0] if device.written else at
    return max(last - at, 0)
