"""The fault table: what goes wrong, when, with which limits, and how it is made to go wrong."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault

# ramp_pos: preload to sample ~230, adjustment to ~390, rest to ~590, command phase to ~1590, release to ~1800.
WHEN = {"start": 20, "middle": 1000, "end": 1500}
# The widest that each limit can be, so that the one in question is passed first.
OTHERS: dict[str, dict[str, int | str]] = {
    "arm": {"arm_deg": 360, "arm_speed_deg_per_s": 30000, "tracking_deg": "null"},
    "pump": {
        "pump_travel_mm": 50,
        "pump_speed_mm_per_s": 1200,
        "pump_following_deg": "null",
        "arm_silent_mm": "null",
    },
}


@dataclass(frozen=True)
class Case:
    """One row: ``fault`` of the virtual rig or an ``action`` in the loop, overrides, words that must be said."""

    name: str
    fault: str = ""
    lines: tuple[str, ...] = ()
    says: str = ""
    action: str = ""


def alone(kind: str, limit: str) -> tuple[str, ...]:
    """Return the overrides that leave of a group of limits only one."""
    others = [f"rig.limits.{name}={widest}" for name, widest in OTHERS[kind].items() if name != limit]
    return (*others, "++rig.limits.arm_silent_deg=null")


CASES = (
    Case("fault: stuck arm encoder", "stuck_encoder", says="tracking|silent|speed"),
    Case("fault: stuck pump encoder", "stuck_pump_encoder", says="silent"),
    Case("fault: lost pressure sensor", "lost_sensor", says="sensor 1 is lost"),
    Case("fault: burst line", "burst_line", says="lose water|pressure|speed|tracking|silent"),
    Case("fault: late samples", "late_samples", says="5 samples were missed at once"),
    Case("fault: device disappears", "device_gone", says="THE OUTPUTS COULD NOT BE WRITTEN"),
    Case("fault: error code", "error_code", says="error -200361"),
    Case("fault: sample clock stops", "clock_stopped", says="error -200284"),
    Case("limit: pressure above", "pressure_spike", ("rig.limits.pressure_high_mpa=0.75",), "is above 0.75 MPa"),
    Case("limit: pressure below", "pressure_drop", ("rig.limits.pressure_low_mpa=-0.108",), "is below -0.108 MPa"),
    Case("limit: sum of pressures", "pressure_drop", ("rig.limits.pressure_sum_low_mpa=0.5",), "lose water|is above"),
    Case("limit: pump travel", "pump_jump", alone("pump", "pump_travel_mm"), "pump at"),
    Case("limit: pump speed", "pump_jump", alone("pump", "pump_speed_mm_per_s"), "pump speed"),
    Case("limit: pump following", "pump_jump", alone("pump", "pump_following_deg"), "behind its command"),
    Case("limit: arm angle", "arm_jump", alone("arm", "arm_deg"), "arm at"),
    Case("limit: arm speed", "arm_jump", alone("arm", "arm_speed_deg_per_s"), "arm speed"),
    Case("limit: tracking error", "arm_jump", alone("arm", "tracking_deg"), "tracking error"),
    Case(
        "limit: samples missed in all",
        "one_late_sample",
        ("rig.limits.missed_in_all=0",),
        "1 sample was missed in all",
    ),
    Case("limit: output clipped", action="clipped", says="output pump is clipped: 229"),
    Case("stop: SIGTERM", action="sigterm", says="SIGTERM was received"),
    Case("stop: Ctrl-C twice", action="sigint", says="Ctrl-C"),
    Case("stop: exception in the loop", action="exception", says="RuntimeError: boom"),
    Case("stop: disk full", action="disk", says="No space left"),
)


def arm_case(case: Case, sample: int, device: VirtualDevice, monkeypatch: Any) -> None:
    """Switch the fault of a case on, once: the test that is made first after it."""
    if case.fault:
        device.faults = [Fault(case.fault, sample, device.tests + 1)]
        return
    actions: dict[str, Callable[[], None]] = {
        "sigterm": lambda: os.kill(os.getpid(), signal.SIGTERM),
        "sigint": _ctrl_c_twice,
        "exception": _boom,
    }
    if case.action == "disk":
        _fill_the_disk(sample, device, monkeypatch)
        return
    from hjcamp.plants.pump_joint.rig.control import COMMAND, RigControl

    step = RigControl.step
    test = device.tests + 1

    def interrupted(self: RigControl, *arguments: float) -> Any:
        due = device.tests == test and device.samples == sample
        if due and case.action in actions:
            actions[case.action]()
        out = step(self, *arguments)
        if due and case.action == "clipped":
            out[COMMAND] = 1000.0  # rad
        return out

    monkeypatch.setattr(RigControl, "step", interrupted)


def _ctrl_c_twice() -> None:
    os.kill(os.getpid(), signal.SIGINT)
    os.kill(os.getpid(), signal.SIGINT)


def _boom() -> None:
    raise RuntimeError("boom")


def _fill_the_disk(sample: int, device: VirtualDevice, monkeypatch: Any) -> None:
    from hjcamp.plants.pump_joint.rig.journal import Journal

    write = Journal._write
    test = device.tests + 1

    def full(self: Journal) -> None:
        if device.tests == test and device.samples >= sample:
            raise HjcampError(f"{self._recording.path if self._recording else ''}: cannot be written: No space left on device")
        write(self)

    add = Journal.add

    def add_and_wait(self: Journal, held: int) -> None:
        # Virtual time can outrun the writing thread: let it meet the full disk before the next sample.
        add(self, held)
        if device.tests == test and device.samples >= sample:
            self._wake.set()
            until = time.monotonic() + 5.0
            while self.problem is None and time.monotonic() < until:
                time.sleep(0.001)

    monkeypatch.setattr(Journal, "_write", full)
    monkeypatch.setattr(Journal, "add", add_and_wait)
