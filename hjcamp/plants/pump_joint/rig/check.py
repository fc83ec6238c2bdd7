"""The check of a rig before anything of a campaign moves: wiring, noise, preload, directions of pump and arm."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import pi
from typing import Any

import numpy as np
from nidaqmx.errors import Error

from hjcamp.errors import RigStopped, UsageError
from hjcamp.plants.pump_joint.rig.left import LeftAt
from hjcamp.plants.pump_joint.rig.limits import COMMAND_PHASE, LimitCheck, limit_check, read_limits
from hjcamp.plants.pump_joint.rig.tasks import AT_START, RigTasks, device_facts, first_line, last_words, not_written
from hjcamp.plants.pump_joint.rig.wiring import read_wiring
from hjcamp.storage import check_place

DEGREE = pi / 180
PERIOD = 1e-3
NOISE_SAMPLES = 500
NOISE_MPA = 0.01
FORWARD, BACK = 1.0, -1.0
PUMP_TRAVEL = 0.2  # mm, first motion
FARTHEST_TRAVEL = 2.5  # mm, until the arm must have turned
ARM_DEG = 4.0
RISE_MPA = 0.02


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at."""

    name: str
    passed: bool
    text: str


@dataclass
class RigCheck:
    """Small motions on open tasks, under the limits of the rig.

    Angles in rad, pressures in Pa. Every step needs the ones before it, so the first that fails ends the check.
    """

    tasks: RigTasks
    limits: LimitCheck
    config: Mapping[str, Any]
    asked_to_stop: Callable[[], str | None] = lambda: None
    facts: str = ""
    command: float = 0.0
    arm: float = 0.0
    motor: float = 0.0
    pressures: tuple[float, float] = (0.0, 0.0)
    out: Any = field(default_factory=lambda: np.zeros(7))

    def run(self, announce: Callable[[str], None]) -> Iterator[Finding]:
        """Yield the findings in order; ``announce`` hears of each step before it moves anything."""
        steps = {
            "sensors and encoders at rest, nothing moves": self.at_rest,
            f"preload: both lines to {self.config['procedure']['preload_mpa']:g} MPa": self.preload,
            f"the pump forward by {PUMP_TRAVEL:g} mm": self.pump_direction,
            f"the arm by about {ARM_DEG:g} deg in the positive direction, look at it": self.arm_direction,
        }
        for words, step in steps.items():
            announce(words)
            finding = step()
            yield finding
            if not finding.passed:
                break
        else:
            announce("the pump back to its start, the lines released")
            yield self.go_back()
            return
        if step != self.at_rest:
            announce("the lines released")
            yield self.release()

    def sample(self, preload_speed: float = 0.0) -> None:
        """Read one sample, check it, write the present command."""
        tasks, wiring = self.tasks, self.tasks.wiring
        try:
            missed = tasks.read()
            self.arm = wiring.encoders["arm"].sign * tasks.counts[0] * wiring.encoders["arm"].count
            self.motor = wiring.encoders["pump"].sign * tasks.counts[1] * wiring.encoders["pump"].count
            one, two = (wiring.pressures[f"pressure{i + 1}"].pascal(float(tasks.volts[i])) for i in range(2))
            self.pressures = (one, two)
            self.out[2] = self.command
            if self.out[0] == COMMAND_PHASE:
                self.out[1] = self.arm  # there is no reference to follow
            reason = self.asked_to_stop() or self.limits.check(missed, tasks.volts, one, two, self.arm, self.motor, self.out)
            if reason is None:
                tasks.write(self.command, self.motor, 0.0, preload_speed)
                self.command = tasks.put_out[0]
                reason = self.limits.clipped(tasks.beyond, wiring.outputs)
        except Error as error:
            reason = first_line(error)
        if reason is not None:
            raise RigStopped(f"the rig was made safe during the check: {reason}")

    def at_rest(self) -> Finding:
        """Nothing moves: sensors within their range, little noise, encoders still."""
        rows = np.zeros((NOISE_SAMPLES, 4))
        for row in rows:
            self.sample()
            row[:] = (*self.pressures, self.arm, self.motor)
        noise = rows[:, :2].std(axis=0) * 1e-6
        count = self.tasks.wiring.encoders["arm"].count
        turned = np.ptp(rows[:, 2]) / count
        text = f"noise {noise[0]:.4f} and {noise[1]:.4f} MPa, arm encoder moved {turned:.0f} counts"
        if noise.max() > NOISE_MPA:
            return Finding("at rest", False, f"{text}: more than {NOISE_MPA:g} MPa; look at wiring and shielding")
        if turned > 1 or np.ptp(rows[:, 3]) > 2 * self.tasks.wiring.encoders["pump"].count:
            return Finding("at rest", False, f"{text}: something moves, or an encoder is disturbed")
        return Finding("at rest", True, text)

    def preload(self) -> Finding:
        """Both lines rise to the preload pressure."""
        given = self.config["procedure"]
        start, wanted = self.pressures, given["preload_mpa"] * 1e6
        for _ in range(round(given["phase_limit_s"] / PERIOD)):
            if min(self.pressures) >= wanted:
                break
            self.sample(given["preload_speed_mm_per_s"] * 1e-3)
        rise = [(now - then) * 1e-6 for now, then in zip(self.pressures, start, strict=True)]
        text = f"lines rose by {rise[0]:.3f} and {rise[1]:.3f} MPa"
        if min(self.pressures) < wanted:
            return Finding("preload", False, f"{text}: {given['preload_mpa']:g} MPa was not reached in both")
        return Finding("preload", True, text)

    def pump_direction(self) -> Finding:
        """A positive command turns the pump encoder up, raises line 1 and lowers line 2."""
        before = self.pressures
        self.drive(lambda: self.travel() >= PUMP_TRAVEL, FORWARD, 2 * PUMP_TRAVEL)
        first, second = ((now - then) * 1e-6 for now, then in zip(self.pressures, before, strict=True))
        text = f"at {self.travel():.2f} mm, line 1 {first:+.3f} MPa, line 2 {second:+.3f} MPa"
        if self.travel() < 0.5 * PUMP_TRAVEL:
            return Finding("pump", False, f"{text}: the encoder does not follow; wrong sign, wiring or drive disabled")
        if first < RISE_MPA or second > -RISE_MPA:
            return Finding("pump", False, f"{text}: line 1 must rise and line 2 fall; the sensors may be exchanged")
        return Finding("pump", True, text)

    def arm_direction(self) -> Finding:
        """A positive command turns the arm encoder up."""
        start = self.arm
        self.drive(lambda: abs(self.arm - start) >= ARM_DEG * DEGREE, FORWARD, FARTHEST_TRAVEL)
        turned = (self.arm - start) / DEGREE
        text = f"the arm encoder turned by {turned:+.1f} deg"
        if abs(turned) < 0.5 * ARM_DEG:
            return Finding("arm", False, f"{text} with the pump at {self.travel():.2f} mm: stuck, or not wired")
        if turned < 0:
            return Finding("arm", False, f"{text}: the wrong way; set rig.inputs.arm.sign to its negative")
        return Finding("arm", True, text)

    def go_back(self) -> Finding:
        """The pump goes back, then the lines are released."""
        self.drive(lambda: self.command <= 0.0, BACK, 2 * FARTHEST_TRAVEL)
        return self.release()

    def release(self) -> Finding:
        """The lines are released."""
        given = self.config["procedure"]
        for _ in range(round(given["phase_limit_s"] / PERIOD)):
            if max(self.pressures) < given["release_mpa"] * 1e6:
                break
            self.sample(-given["preload_speed_mm_per_s"] * 1e-3)
        low = max(self.pressures) * 1e-6
        return Finding("release", low < given["release_mpa"] * 1.5, f"lines released to {low:.3f} MPa")

    def travel(self) -> float:
        """Return where the pump stands, mm."""
        return float(self.motor / (2 * pi) * self.config["pump"]["lead_mm_per_rev"])

    def drive(self, reached: Callable[[], bool], direction: float, farthest: float) -> None:
        """Move the pump at the speed of the pressure adjustment until ``reached`` or ``farthest`` (mm)."""
        speed = self.config["procedure"]["adjustment"]["speed_mm_per_s"]
        step = direction * 2 * pi * speed / self.config["pump"]["lead_mm_per_rev"] * PERIOD
        for _ in range(round(farthest / speed / PERIOD)):
            if reached():
                break
            self.command += step
            self.sample()


@contextmanager
def open_check(config: Mapping[str, Any], seed: int | None, left: LeftAt) -> Iterator[RigCheck]:
    """Give a check on open tasks; whatever happens, the outputs end in their safe state and the tasks are cleared.

    ``seed`` of the joint that a virtual rig gets, None: the one that is on it. ``left`` is where motor and arm stand.
    """
    from hjcamp.backends.rig.guard import require_guard
    from hjcamp.backends.rig.stop import while_moving
    from hjcamp.plants.pump_joint.rig.connection import connect
    from hjcamp.plants.pump_joint.rig.park import note_parked

    wiring, limits = read_wiring(config), read_limits(config)
    with while_moving() as signals:
        connection = connect(config, seed)
        try:
            require_guard(config)
            facts = device_facts(wiring, connection)
            tasks = RigTasks(wiring, connection, limits.read_timeout_ms * 1e-3, left)
            check = RigCheck(tasks, limit_check(config, wiring), config, lambda: signals.reason, facts)
            check.command, check.motor, check.arm = left.motor, left.motor, left.arm
            signals.last_words = lambda: last_words(tasks)
            try:
                yield check
            finally:
                problem = tasks.make_safe(check.motor)
                note_parked(config, wiring, None if problem else tasks.stands_at(check.motor))
                tasks.close()
                if problem is not None:
                    raise RigStopped(not_written(tasks, problem))
        finally:
            connection.close()


def check_rig(
    config: Mapping[str, Any],
    ask: Callable[[str], bool],
    say: Callable[[Finding], None],
    seed: int = 1,
    before: Callable[[], None] = lambda: None,
    announce: Callable[[str], None] = lambda words: None,
) -> bool:
    """Check the rig of a resolved configuration; ``say`` hears each finding. Returns whether all passed.

    ``before`` is called last before the outputs are taken, ``announce`` before each step; ``ask`` puts its question when
    the lines are released and the outputs safe. Raises ``RigStopped`` where a limit was passed.
    """
    from hjcamp.plants.pump_joint.rig.check_stamp import stamp_path, write_stamp
    from hjcamp.plants.pump_joint.rig.lock import take_lock
    from hjcamp.plants.pump_joint.rig.reach import check_test

    if config["backend"]["name"] != "nidaqmx":
        raise UsageError("hjcamp rig check needs backend=nidaqmx")
    check_test(config)
    # What passes must be kept: that there is no place for it is said before anything moves.
    check_place(stamp_path(config))
    take_lock(config)
    before()
    passed: list[Finding] = []

    def note(finding: Finding) -> None:
        passed.append(finding)
        say(finding)

    with open_check(config, seed, AT_START) as check:
        for finding in check.run(announce):
            note(finding)
    if all(finding.passed for finding in passed):
        question = f"The arm should have turned by about {ARM_DEG:g} deg in the positive direction, and back. Did it?"
        seen = ask(question)
        wrong = "the user did not see the arm turn: wrong encoder or wrong lines"
        note(Finding("seen", seen, "the user saw the arm turn" if seen else wrong))
    if not all(finding.passed for finding in passed):
        return False
    write_stamp(config, {"devices": check.facts, **{finding.name: finding.text for finding in passed}})
    return True
