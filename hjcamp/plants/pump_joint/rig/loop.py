"""The 1 kHz loop of one test: read, check, control, write, note; whatever happens, the rig ends safe."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import copysign, isfinite

from nidaqmx.errors import Error

from hjcamp.backends.rig.timing import LoopTiming
from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.rig.control import COMMAND, DITHER, PHASE, PRELOAD_SPEED, RigControl
from hjcamp.plants.pump_joint.rig.journal import Journal
from hjcamp.plants.pump_joint.rig.limits import COMMAND_PHASE, RELEASE_PHASE, LimitCheck
from hjcamp.plants.pump_joint.rig.tasks import RigTasks, first_line

FAILED_PHASE = 6.0
PERIOD = 1e-3


class Stopped(HjcampError):  # noqa: N818 - it is a state of the loop
    """A limit was passed, or the device reported a fault."""


class StoppedForGood(Stopped):
    """Somebody asked to stop, or nothing more can be logged: the run must not go on by itself."""


@dataclass
class RigLoop:
    """One test on open tasks. ``asked`` returns why to stop now, or None."""

    tasks: RigTasks
    control: RigControl
    limits: LimitCheck
    journal: Journal
    timing: LoopTiming
    asked: Callable[[], str | None]
    motor: float = 0.0
    arm: float = 0.0

    def run(self) -> None:
        """Make the test to the end of its release phase; raises ``Stopped`` with the reason of an early end."""
        control, journal = self.control, self.journal
        out = control.out
        longest = len(journal.rows)
        while True:
            missed, pressure1, pressure2, arm = self.read()
            self.check(missed, pressure1, pressure2, arm)
            control.step(pressure1, pressure2, arm, 1.0 + missed)
            phase = out[PHASE]
            if phase > RELEASE_PHASE:
                break
            self.write(out[COMMAND], out[DITHER], out[PRELOAD_SPEED])
            if journal.count + missed + 1 > longest:
                raise Stopped("the test takes longer than its phases may")
            row = journal.rows[journal.count]
            row[:6] = out[:6]
            row[6], row[7], row[8], row[9] = arm, pressure1, pressure2, self.motor
            if phase == COMMAND_PHASE and journal.first < 0:
                journal.first = journal.count + missed
            journal.add(missed)
            self.check_range()
        if phase >= FAILED_PHASE:
            raise Stopped(
                "the preload or the pressure adjustment took longer than procedure.phase_limit_s: a leak, a wrong "
                "sensor, or a drive that does not move"
            )

    def return_to_start(self, speed: float) -> None:
        """Drive the pump back to where it started, at ``speed`` (rad/s), under the same limits; not logged."""
        out = self.control.out
        out[PHASE] = RELEASE_PHASE
        command = out[COMMAND] = self.tasks.put_out[0]
        step = speed * PERIOD
        while command != 0.0:
            missed, pressure1, pressure2, arm = self.read()
            self.check(missed, pressure1, pressure2, arm, "while the pump returned to its start: ")
            command = 0.0 if abs(command) <= step else command - copysign(step, command)
            self.write(command, 0.0, 0.0)
            self.check_range("while the pump returned to its start: ")

    def read(self) -> tuple[int, float, float, float]:
        """Wait for the next sample; return samples missed, pressures (Pa) and arm angle (rad)."""
        tasks, wiring = self.tasks, self.tasks.wiring
        try:
            missed = tasks.read()
        except Error as error:
            raise Stopped(f"reading failed: {first_line(error)}") from error
        self.timing.cycle(time.perf_counter_ns(), missed)
        encoders = wiring.encoders
        self.arm = arm = encoders["arm"].sign * tasks.counts[0] * encoders["arm"].count
        self.motor = encoders["pump"].sign * tasks.counts[1] * encoders["pump"].count
        pressure1 = wiring.pressures["pressure1"].pascal(float(tasks.volts[0]))
        return missed, pressure1, wiring.pressures["pressure2"].pascal(float(tasks.volts[1])), arm

    def write(self, command: float, dither: float, preload_speed: float) -> None:
        """Write the outputs (rad, V, m/s); what they really gave stands in the row of ``decide`` from here on."""
        if not isfinite(command + dither + preload_speed):
            raise Stopped(f"the control law asks for {command:g} rad, {dither:g} V, {preload_speed:g} m/s")
        try:
            self.tasks.write(command, self.motor, dither, preload_speed)
        except Error as error:
            raise Stopped(f"writing failed: {first_line(error)}") from error
        self.control.out[COMMAND], self.control.out[DITHER] = self.tasks.put_out

    def check_range(self, when: str = "") -> None:
        """Raise ``Stopped`` where an output could not give what it was asked for."""
        reason = self.limits.clipped(self.tasks.beyond, self.tasks.wiring.outputs)
        if reason is not None:
            raise Stopped(f"{when}{reason}")

    def check(self, missed: int, pressure1: float, pressure2: float, arm: float, when: str = "") -> None:
        """Raise ``Stopped`` where this sample says that the rig must be made safe."""
        asked = self.asked()
        if asked is not None:
            raise StoppedForGood(f"{when}{asked}")
        if self.journal.problem is not None:
            raise StoppedForGood(f"{when}the log cannot be written: {self.journal.problem}")
        reason = self.limits.check(missed, self.tasks.volts, pressure1, pressure2, arm, self.motor, self.control.out)
        if reason is not None:
            raise Stopped(f"{when}{reason}")
