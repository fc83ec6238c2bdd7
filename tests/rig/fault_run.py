"""Makes one row of the fault table: a run of two tests that is stopped, looked at, and resumed."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fault_cases
import pytest
from fault_cases import WHEN, Case
from rich.console import Console

from hjcamp.campaign.files.run_folder import folder_for, open_folder
from hjcamp.campaign.plan.planning import make_plan
from hjcamp.campaign.runner import run_plan
from hjcamp.errors import HjcampError, UsageError
from hjcamp.plants.pump_joint.rig import connection as rig_connection
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.records.read import read_log
from hjcamp.records.recover import recover_log

DITHER, PRELOAD, PUMP = "Dev1/ao2", "Dev1/ao1", "Dev1/ao0"
V_PER_DEG, DEG_PER_COUNT = 0.004, 0.18


@dataclass(frozen=True)
class Row:
    """What a case showed."""

    case: str
    when: str
    outputs: str
    log: str
    code: int
    resumed: str
    message: str
    folder: str = ""

    def line(self) -> str:
        """Return the row of the table, without what may differ from run to run."""
        return f"| {self.case} | {self.when} | {self.outputs} | {self.log} | {self.code} | {self.resumed} |"


def make_row(case: Case, when: str, folder: Path, composer: Any, monkeypatch: pytest.MonkeyPatch) -> Row:
    """Run, stop, look and resume."""
    lines = ["backend=nidaqmx", "trajectory=ramp_pos", "repetitions=2", *case.lines]
    plan = make_plan(composer.compose(lines).config, None, lines, composer)
    run = folder_for(plan, {}, [], folder / "run")[0]
    device = rig_connection.in_process_channel().device
    console = Console(file=io.StringIO())
    message, code = "", 0
    with monkeypatch.context() as patches:
        fault_cases.arm_case(case, WHEN[when], device, patches)
        try:
            result = run_plan(run, console)
            assert not result.failures, result.failures
        except HjcampError as error:
            message, code = str(error), error.exit_code
    log, kept = readable(folder / "run", plan.tests[0].log, folder) if code else ("whole", 0)
    outputs = safe_outputs(device, case, when, kept, message) if code else "safe (test ended)"
    device.faults = []
    if code:
        run_plan(open_folder(folder / "run"), console)
    whole = [read_log(folder / "run" / test.log) for test in plan.tests]
    resumed = f"{len(whole)} of {len(plan.tests)} tests" if open_folder(folder / "run").complete else "NOT COMPLETE"
    if code:
        assert re.search(case.says, message), message
    return Row(case.name, when, outputs, log, code, resumed, message, str(folder))


def safe_outputs(device: VirtualDevice, case: Case, when: str, kept: int, message: str) -> str:
    """Check that the loop ended with the sample that showed the fault, and that the outputs are safe and stayed so."""
    assert device.volts[DITHER] == 0.0, device.volts
    assert device.volts[PRELOAD] == 0.0, device.volts
    missed = 5 if case.fault == "late_samples" else 0
    if not device.gone and not missed:
        held, motor = device.volts[PUMP] / V_PER_DEG, device.counts("pump") * DEG_PER_COUNT
        # Where the pump encoder itself is what is wrong, its last reading is all that is known.
        assert abs(held - max(min(motor, 2500.0), -2500.0)) < DEG_PER_COUNT, (held, motor)
    # Nothing was read, and no virtual time passed, after the sample that made the loop stop.
    if "returned to its start" not in message and case.action != "disk":
        assert device.samples - kept <= 2 + missed, (device.samples, kept)
    at_once = {"lost_sensor", "late_samples", "device_gone", "error_code", "clock_stopped", "pressure_spike"}
    if case.fault in at_once or case.action in ("sigterm", "sigint", "exception", "clipped"):
        assert device.samples - WHEN[when] <= 2 + missed, (device.samples, WHEN[when])
    return "safe within 2 samples"


def readable(run: Path, log: str, folder: Path) -> tuple[str, int]:
    """Return whether what was logged until the stop can be read, and how many samples that is."""
    # What a killed client leaves before the command phase has a name of its own.
    parts = [run / (log + ".part"), run / log.replace(".mcap", ".before.mcap.part")]
    part = next((path for path in parts if path.exists()), parts[0])
    assert part.exists(), list(run.rglob("*"))
    assert not (run / log).exists()
    try:
        result = recover_log(part, folder / "recovered.mcap")
    except UsageError as error:
        assert "holds no messages" in str(error)
        return "nothing yet", 0
    assert result.kept > 0
    return "recovered", result.kept
