"""What the logs say, prepared for driving a model: smoothed states on a coarser clock, windows, hardware of each test."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError, counted
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import Hardware, hardware_of
from hjcamp.plants.pump_joint.diagnosis.measured.signals import (
    PERIOD,
    SLIDING_MARGIN,
    STRIDE,
    breakaways,
    misfit_of,
    slider_motion,
    smooth,
    yielding,
)
from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
DEGREE = math.pi / 180
WINDOW = 0.3
SLIDING_SPEED = 4e-3
STEADY = 0.3
LEAST_HOME = 0.5
MOST_HOME = 3.0


@dataclass(frozen=True)
class TestEvidence:
    """One test on the coarse clock, SI: n samples ``PERIOD`` apart.

    ``arm`` (rad), ``pressure1``, ``pressure2`` (Pa) and ``pump`` (rad of the motor) are means over one coarse sample;
    ``velocity`` (m/s) is the sliders' speed, 0 where they rest; ``track`` (m) and ``acceleration`` (m/s^2) belong to it; ``misfit``
    (counts) is how far the counted angle is from that smooth motion; ``breaks`` (events,) are the samples at which the arm breaks away;
    ``home`` (rad) is the first reading of a test that begins at the arm's own zero, NaN where that is not known.
    """

    name: str
    condition: str
    time: Array
    arm: Array
    pressure1: Array
    pressure2: Array
    pump: Array
    command: Array | None
    dither: Array
    velocity: Array
    track: Array
    acceleration: Array
    misfit: Array
    breaks: NDArray[np.int64]
    home: float
    hardware: Hardware
    log: TestLog

    @cached_property
    def samples(self) -> int:
        """Number of coarse samples."""
        return len(self.time)


def prepare_test(log: TestLog) -> TestEvidence:
    """Return the command phase of one log on the coarse clock."""
    columns = log.command_phase
    name = log.path.name if log.path else log.condition_key
    hardware = hardware_of(log)
    arm = columns["arm_deg"] * DEGREE
    if len(arm) < 10 * STRIDE:
        raise UsageError(f"{name}: {counted(len(arm), 'sample')} in the command phase; at least {10 * STRIDE} are needed")
    pump = columns["pump_deg"] * DEGREE if "pump_deg" in columns else hardware.pump_motion(columns["command_deg"] * DEGREE)
    pick = slice(0, None, STRIDE)
    half = STRIDE // 2
    travel, velocity, acceleration = slider_motion(arm, hardware.values["pulley_radius"], STRIDE)
    return TestEvidence(
        name=name,
        condition=log.condition_key,
        time=columns["time_s"][pick],
        arm=smooth(arm, half)[pick],
        pressure1=smooth(columns["pressure1_mpa"], half)[pick] * 1e6,
        pressure2=smooth(columns["pressure2_mpa"], half)[pick] * 1e6,
        pump=smooth(pump, half)[pick],
        command=columns["command_deg"] * DEGREE if "command_deg" in columns else None,
        dither=_loudest(np.abs(columns.get("dither_v", np.zeros(len(arm))))),
        velocity=velocity,
        track=travel,
        acceleration=acceleration,
        misfit=misfit_of(arm[pick], travel, hardware.values),
        breaks=breakaways(arm, hardware.values["encoder_count"]),
        home=home_reading(log),
        hardware=hardware,
        log=log,
    )


def home_reading(log: TestLog) -> float:
    """Return the arm's first reading (rad) where the test begins at the arm's zero and nothing has moved it there.

    A loop that was closed before the log began may have driven the reading, not the arm, to zero: NaN, as without a
    reference.
    """
    columns, command = log.columns, log.command_phase
    if "reference_deg" not in columns or len(command["time_s"]) == 0 or abs(command["reference_deg"][0]) > 1e-6:
        return math.nan
    from_before = len(command["time_s"]) < len(columns["time_s"])
    closed = log.metadata.get("controller", "") != "open_loop" and np.any(columns.get("pid_deg", 1.0))
    return math.nan if closed and not from_before else float(columns["arm_deg"][0]) * DEGREE


def _loudest(values: Array) -> Array:
    padded = np.pad(values, (0, -len(values) % STRIDE))
    return np.asarray(padded.reshape(-1, STRIDE).max(axis=1))


@dataclass(frozen=True)
class Evidence:
    """All tests one after the other; tests of equal ``condition`` are repetitions of each other.

    ``odd`` says which logs differ from their repetitions by more than these do from each other: nothing is concluded with them.
    """

    tests: tuple[TestEvidence, ...]
    odd: tuple[str, ...] = ()

    @cached_property
    def edges(self) -> NDArray[np.int64]:
        """Where each test begins, and the total number of samples at the end."""
        return np.concatenate([[0], np.cumsum([test.samples for test in self.tests])])

    @cached_property
    def conditions(self) -> dict[str, list[int]]:
        """Positions of the tests of each condition."""
        found: dict[str, list[int]] = {}
        for index, test in enumerate(self.tests):
            found.setdefault(test.condition, []).append(index)
        return found

    @cached_property
    def of_test(self) -> NDArray[np.int64]:
        """The position of the test that each sample belongs to."""
        return np.repeat(np.arange(len(self.tests)), [test.samples for test in self.tests])

    def joined(self, name: str) -> Array:
        """Return one quantity of all tests, joined."""
        return np.concatenate([getattr(test, name) for test in self.tests])

    @cached_property
    def restart(self) -> NDArray[np.int64]:
        """2 where a test begins, 1 where a window of the joint view begins, else 0."""
        marks = np.zeros(int(self.edges[-1]), dtype=np.int64)
        width = round(WINDOW / PERIOD)
        for begin, end in zip(self.edges[:-1], self.edges[1:], strict=True):
            marks[begin:end:width] = 1
            marks[begin] = 2
        return marks

    @cached_property
    def sliding(self) -> NDArray[np.bool_]:
        """Where the arm slides steadily enough to read its friction off the pressures (n,)."""
        velocity = self.joined("velocity")
        moving = (np.abs(velocity) > SLIDING_SPEED) & (np.abs(self.joined("acceleration")) < STEADY)
        smooth = np.abs(self.joined("misfit")) < 1.0
        for shift in range(-SLIDING_MARGIN, SLIDING_MARGIN + 1):
            moving &= (np.roll(velocity, shift) * velocity > 0) & np.roll(smooth, shift)
        moving &= ~yielding(velocity, self.joined("pressure1") - self.joined("pressure2"))
        for edge in self.edges[:-1]:
            moving[edge : edge + SLIDING_MARGIN] = False
        for edge in self.edges[1:]:
            moving[edge - SLIDING_MARGIN : edge] = False
        return moving

    @cached_property
    def breakaways(self) -> NDArray[np.int64]:
        """Samples (events,) at which the count of the resting arm first changes."""
        return np.concatenate([test.breaks + edge for test, edge in zip(self.tests, self.edges[:-1], strict=True)])

    @cached_property
    def homes(self) -> Array:
        """Where each test begins (tests,), rad, NaN where not known.

        Not for arms that begin more than three counts apart from each other: nobody brings those to their zero.
        """
        homes = np.array([test.home for test in self.tests])
        known = homes[np.isfinite(homes)]
        apart = len(known) > 1 and np.std(known, ddof=1) > MOST_HOME * self._count
        return np.full(len(homes), np.nan) if apart else homes

    @cached_property
    def home_scatter(self) -> float:
        """Standard deviation (rad) of where tests begin, at least half a count."""
        known = self.homes[np.isfinite(self.homes)]
        return max(float(np.std(known, ddof=1)) if len(known) > 1 else 0.0, LEAST_HOME * self._count)

    @cached_property
    def _count(self) -> float:
        return max(test.hardware.values["encoder_count"] for test in self.tests)

    @cached_property
    def repeated(self) -> bool:
        """Whether any condition has more than one repetition."""
        return any(len(tests) > 1 for tests in self.conditions.values())

    def only(self, keep: Sequence[int]) -> Evidence:
        """Return the evidence of the tests at these positions."""
        return Evidence(tuple(self.tests[index] for index in keep), self.odd)


def prepare(logs: Sequence[TestLog], odd: tuple[str, ...] = ()) -> Evidence:
    """Return the evidence of all logs; refuse logs of mixed hardware and an empty list."""
    from hjcamp.records.find import refuse_mixed_hardware

    if not logs:
        raise UsageError("no tests: give a run folder, a folder of logs, or log files")
    refuse_mixed_hardware(list(logs))
    return Evidence(tuple(prepare_test(log) for log in by_repetition(logs)), odd)


def by_repetition(logs: Sequence[TestLog]) -> list[TestLog]:
    """Return the logs with the repetitions of each condition in the order of their numbers, whatever their files are called.

    The last repetition is what is held out first. Logs of a condition of which one has no number stay in the order of the files.
    """
    places: dict[str, list[int]] = {}
    for place, log in enumerate(logs):
        places.setdefault(log.condition_key, []).append(place)
    found = list(logs)
    for of_condition in places.values():
        numbers = {place: logs[place].metadata.get("repetition", "") for place in of_condition}
        if all(number.isdecimal() for number in numbers.values()):
            for place, earlier in zip(of_condition, sorted(of_condition, key=lambda one: int(numbers[one])), strict=True):
                found[place] = logs[earlier]
    return found
