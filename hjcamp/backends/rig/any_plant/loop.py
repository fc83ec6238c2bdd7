"""The loop of one test of any plant: read, check, control, write, note; whatever happens, the rig ends safe."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from hjcamp.backends.rig.any_plant.control import PlantControl
from hjcamp.backends.rig.any_plant.driver import Driver, DriverFailed
from hjcamp.backends.rig.any_plant.limits import PlantLimits
from hjcamp.backends.rig.journal import Journal
from hjcamp.backends.rig.timing import LoopTiming
from hjcamp.backends.schedule import CONTROL
from hjcamp.errors import HjcampError
from hjcamp.rigs.fit import Wiring, scales


class Stopped(HjcampError):  # noqa: N818 - it is a state of the loop
    """A limit was passed, or the driver failed."""


class StoppedForGood(Stopped):
    """Somebody asked to stop, or nothing more can be logged: the run must not go on by itself."""


@dataclass
class Clock:
    """When samples are due: by the device that paces, in lockstep, or by this computer's clock at ``period`` s."""

    driver: Driver
    period: float
    _count: int = -1
    _began: float = 0.0
    _number: int | None = None

    def next(self) -> tuple[int, list[float]]:
        """Wait for the next sample; return how many were missed since the last one, and what the driver reads."""
        rig = self.driver.rig
        if not rig.paced and not rig.lockstep:
            return self._by_ourselves()
        values = self.driver.read(self.period)
        before, self._number = self._number, rig.sample
        now, last = time.perf_counter(), self._began
        self._began, self._count = now, self._count + 1
        if before is not None and self._number is not None:
            missed = self._number - before - 1
            if missed < 0:
                raise DriverFailed(f"read() gave sample {self._number} after sample {before}")
        elif rig.lockstep or self._number is not None or self._count == 0:
            missed = 0
        else:
            missed = max(round((now - last) / self.period) - 1, 0)
        return missed, values

    def _by_ourselves(self) -> tuple[int, list[float]]:
        now = time.perf_counter()
        if self._count < 0:
            self._began, self._count, missed = now, 0, 0
        else:
            due = self._count + 1
            behind = (now - self._began) / self.period - due
            missed = max(int(behind), 0)
            self._count = due + missed
            rest = self._began + self._count * self.period - now
            if rest > 0.0:
                time.sleep(rest)
        return missed, self.driver.read(0.0)


@dataclass
class PlantLoop:
    """One test on an open driver. ``asked`` returns why to stop now, or None; ``sources`` are what the log's columns hold."""

    driver: Driver
    wiring: Wiring
    control: PlantControl
    limits: PlantLimits
    journal: Journal
    timing: LoopTiming
    sources: list[str]
    asked: Callable[[], str | None]

    def __post_init__(self) -> None:
        wiring, control = self.wiring, self.control
        self._clock = Clock(self.driver, control.period)
        self._readings = len(wiring.measured)
        read, given = scales((*wiring.measured, *wiring.read)), scales(wiring.given)
        self._signs, self._sizes = np.sign(read), np.abs(read)
        self._out_signs, self._out_sizes = np.sign(given), np.abs(given)
        self._order = list(wiring.order)
        self._outputs = [control.plant_inputs.index(one.name) for one in wiring.given]
        self._read_inputs = [control.plant_inputs.index(one.name) for one in wiring.read]
        known = ["phase", "reference", *(f"answer.{name}" for name in control.law_results)]
        known += [*control.plant_inputs, *(f"reading.{name}" for name in control.readings)]
        self._columns = [known.index(name) for name in self.sources]

    def run(self) -> None:
        """Make the test to its end; raises ``Stopped`` with the reason of an early one."""
        control, journal, sample = self.control, self.journal, -1
        while sample < control.samples - 1:
            missed, values = self._sensed()
            sample += 1 + missed
            phase, wanted = control.phase(sample), control.wanted(sample)
            self._check(missed, values, wanted if phase == CONTROL else None)
            if sample >= control.samples:
                return  # the last samples were missed, fewer than the limit
            seen = np.asarray(values) / self._sizes
            inputs = control.step(sample, seen[: self._readings])
            inputs[self._read_inputs] = seen[self._readings :]
            self._put_out(inputs)
            row = np.concatenate(([phase, wanted], control.answers, inputs, seen[: self._readings]))
            journal.rows[journal.count] = row[self._columns]
            if phase >= CONTROL:
                journal.first = control.first
            journal.add(missed)

    def _sensed(self) -> tuple[int, list[float]]:
        try:
            missed, read = self._clock.next()
        except DriverFailed as error:
            raise Stopped(str(error)) from error
        self.timing.cycle(time.perf_counter_ns(), missed)
        return missed, (np.asarray(read)[self._order] * self._signs).tolist()

    def _put_out(self, inputs: Any) -> None:
        asked = inputs[self._outputs] * self._out_sizes
        if not np.isfinite(asked).all():
            told = ", ".join(f"{one.name} {value:g}" for one, value in zip(self.wiring.given, asked, strict=True))
            raise Stopped(f"the control law asks for {told}")
        given, reason = self.limits.given_within(asked.tolist())
        put = np.asarray(given)
        try:
            self.driver.write((put * self._out_signs).tolist())
        except DriverFailed as error:
            raise Stopped(str(error)) from error
        inputs[self._outputs] = put / self._out_sizes
        if reason is not None:
            raise Stopped(reason)

    def _check(self, missed: int, values: list[float], wanted: float | None) -> None:
        asked = self.asked()
        if asked is not None:
            raise StoppedForGood(asked)
        if self.journal.problem is not None:
            raise StoppedForGood(f"the log cannot be written: {self.journal.problem}")
        reason = self.limits.check(missed, values, wanted)
        if reason is not None:
            raise Stopped(reason)
