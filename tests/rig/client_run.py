"""Makes one row of the fault table for a client that dies, stops or is cut off: real time, and the rig's own record."""

from __future__ import annotations

import io
import re
import signal
import subprocess
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from fault_run import DITHER, PRELOAD, PUMP, Row, readable
from processes import Cable, connection, program, wait_until
from rich.console import Console

from hjcamp.campaign.files.run_folder import folder_for, open_folder
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import run_plan
from hjcamp.plants.pump_joint.virtual_rig.device import IDLE_S, VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.server import start_server
from hjcamp.records.read import read_log, read_samples

KINDS = ("client: killed (kill -9)", "client: stopped (SIGSTOP)", "client: connection cut")
# Where each phase of ramp_pos is under way, and its number in the log.
PHASES = {"preload": (100, 0), "adjustment": (310, 1), "rest": (490, 2), "command": (1000, 3), "release": (1680, 4)}
RATE = 0.02  # a loaded computer reads and writes within 50 ms
WATCHDOG_SAMPLES = 5
SAMPLES_BY_ITSELF = 8
SAMPLES_AFTER = 20


def make_client_row(kind: str, phase: str, folder: Path, composer: Any) -> Row:
    """Run one test up to a phase, end its client there, look at the rig's own record, and resume."""
    with ExitStack() as stack:
        server, port, device = start_server()
        stack.callback(device.close)
        stack.callback(lambda: server.stop(0).wait())
        cable = Cable(port)
        stack.callback(cable.close)
        lines = ["backend=nidaqmx", "trajectory=ramp_pos", "repetitions=1", connection(cable.port)]
        plan = make_plan(composer.compose(lines).config, None, lines, composer)
        run = folder / "run"
        folder_for(plan, {}, [], run)
        client = stack.enter_context(program(["resume", "run"], folder))
        sample, number = PHASES[phase]
        # The way to the phase in lockstep is faster; then time passes by itself.
        wait_until(lambda: device.samples >= sample, client)
        device.run_by_itself(RATE)
        wait_until(lambda: device.samples >= sample + SAMPLES_BY_ITSELF, client)
        disturb(kind, client, cable)
        outputs = safe_outputs(device, phase)
        client.send_signal(signal.SIGCONT)
        code = client.wait(60.0)
        said = re.sub(r"\s+", " ", (folder / "err.txt").read_text())
        assert (code, said) == (-9, "") if "kill -9" in kind else code == 3, (code, said)
        log, _ = readable(run, plan.tests[0].log, folder)
        assert read_samples(folder / "recovered.mcap", True)[1].columns["phase"][-1] == number
        cable.mend()
        device.run_by_itself(None)
        time.sleep(IDLE_S)
        run_plan(open_folder(run), Console(file=io.StringIO()))
        whole = [read_log(run / test.log) for test in plan.tests]
        resumed = f"{len(whole)} of {len(plan.tests)} tests" if open_folder(run).complete else "NOT COMPLETE"
    message = said.removeprefix("hjcamp: ").partition(" 1 test left")[0]
    return Row(kind, phase, outputs, log, code, resumed, message, str(folder))


def disturb(kind: str, client: subprocess.Popen[str], cable: Cable) -> None:
    """End the client, stop it, or cut its connection."""
    if "kill -9" in kind:
        client.kill()
    elif "SIGSTOP" in kind:
        client.send_signal(signal.SIGSTOP)
    else:
        cable.cut()


def safe_outputs(device: VirtualDevice, phase: str) -> str:
    """Check by the rig's own record that the watchdog made the outputs safe in time, and that they stayed so."""
    assert device.trips == [], "the client was too slow for its watchdog before anything was done to it"
    before = dict(device.volts)
    if phase in ("preload", "release"):
        assert abs(before[PRELOAD]) == 2.0, before  # 1 mm/s: it must not go on
    if phase in ("adjustment", "command"):
        assert before[PUMP] != 0.0, before
    wait_until(lambda: bool(device.trips))
    reset, tripped = device.trips[0]
    assert tripped - reset <= WATCHDOG_SAMPLES, device.trips
    told = [(sample, channel, volts) for sample, channel, volts in device.written if sample <= tripped]
    last = {channel: volts for _, channel, volts in told}
    assert (last[PRELOAD], last.get(DITHER, 0.0)) == (0.0, 0.0), told[-6:]
    # The pump is held at its last command: the watchdog can hold, not measure.
    pump = [volts for sample, channel, volts in device.written if channel == PUMP and sample <= reset]
    assert last.get(PUMP, 0.0) == (pump[-1] if pump else 0.0)
    wait_until(lambda: device.samples > tripped + SAMPLES_AFTER)
    assert np.all([device.volts[PRELOAD] == 0.0, device.volts[DITHER] == 0.0, device.volts[PUMP] == last.get(PUMP, 0.0)])
    return f"safe within {WATCHDOG_SAMPLES} samples"
