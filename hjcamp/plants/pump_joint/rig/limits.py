"""The limits of a rig, checked on every sample: the first one that is passed makes the rig safe."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, pi
from typing import Any

from hjcamp.controllers import find_controller
from hjcamp.errors import counted
from hjcamp.plants.pump_joint.rig.schema import LimitSettings
from hjcamp.plants.pump_joint.rig.silence import RELEASE_PHASE, Coupling, Silence, coupling_of
from hjcamp.plants.pump_joint.rig.wiring import Output, Wiring
from hjcamp.schema import checked

DEGREE = pi / 180
SPEED_SAMPLES = 10
PERIOD = 1e-3
COMMAND_PHASE = 3.0
REST_PHASE = 2.0


@dataclass(frozen=True)
class Limits:
    """The limits in the units of their names; ``None`` in the configuration is no limit."""

    pressure_low_mpa: float
    pressure_high_mpa: float
    pressure_sum_low_mpa: float
    pump_travel_mm: float
    pump_speed_mm_per_s: float
    pump_following_deg: float
    pump_silent_deg: float
    arm_silent_mm: float
    arm_deg: float
    arm_speed_deg_per_s: float
    tracking_deg: float
    missed_at_once: float
    missed_in_all: float
    read_timeout_ms: float
    arm_silent_deg: float = 6.0
    output_clipped_ms: float = 0.0


def read_limits(config: Mapping[str, Any]) -> Limits:
    """Return the limits of ``config["rig"]``; raises ``UsageError`` for one that is missing or out of its bounds."""
    given = checked(LimitSettings, config["rig"].get("limits"), "rig.limits").model_dump()
    none = {name: -inf if "_low_" in name else inf for name in given}
    return Limits(**{name: none[name] if value is None else float(value) for name, value in given.items()})


class LimitCheck:
    """Watches one test; ``check`` and ``clipped`` return the reason to stop, or None. ``lead`` in m per turn.

    ``tracked``: the control law makes the arm follow the reference. An open loop does not: its reference may be an
    angle of the motor, so only before the command phase must the arm stay where it is.
    """

    def __init__(
        self,
        limits: Limits,
        lead: float,
        voltages: tuple[tuple[float, float], tuple[float, float]],
        coupling: Coupling,
        tracked: bool = True,
    ) -> None:
        self.limits = limits
        self.missed = 0
        self._tracked = tracked
        self._clipped = 0
        self._travel = lead / (2 * pi) * 1e3
        self._voltages = voltages
        self._past: deque[tuple[int, float, float]] = deque(maxlen=SPEED_SAMPLES)
        self._sample = 0
        self._silence = Silence(limits.pump_silent_deg, limits.arm_silent_mm, limits.arm_silent_deg, coupling)

    def check(
        self, missed: int, volts: Any, pressure1: float, pressure2: float, arm: float, motor: float, out: Any
    ) -> str | None:
        """Return why the rig must be made safe; pressures in Pa, angles in rad, ``out`` the row of ``decide``.

        ``out`` may still be that of the sample before: the limits come before the law.
        """
        limits = self.limits
        if missed:
            self.missed += missed
            if missed > limits.missed_at_once:
                return f"{counted(missed, 'sample was', 'samples were')} missed at once (limit {limits.missed_at_once:g})"
            if self.missed > limits.missed_in_all:
                return f"{counted(self.missed, 'sample was', 'samples were')} missed in all (limit {limits.missed_in_all:g})"
        for place, (low, high) in enumerate(self._voltages):
            if not low <= volts[place] <= high:
                return f"pressure sensor {place + 1} is lost: {volts[place]:.3f} V is outside {low:g} to {high:g} V"
        one, two = pressure1 * 1e-6, pressure2 * 1e-6
        if max(one, two) > limits.pressure_high_mpa:
            return f"pressure {max(one, two):.3f} MPa is above {limits.pressure_high_mpa:g} MPa"
        if min(one, two) < limits.pressure_low_mpa:
            return f"pressure {min(one, two):.3f} MPa is below {limits.pressure_low_mpa:g} MPa"
        if REST_PHASE <= out[0] < RELEASE_PHASE and one + two < limits.pressure_sum_low_mpa:
            return f"the lines lose water: p1 + p2 = {one + two:.3f} MPa is below {limits.pressure_sum_low_mpa:g} MPa"
        angle, travel = arm / DEGREE, motor * self._travel
        if abs(angle) > limits.arm_deg:
            return f"arm at {angle:.1f} deg, limit {limits.arm_deg:g} deg"
        if abs(travel) > limits.pump_travel_mm:
            return f"pump at {travel:.2f} mm, limit {limits.pump_travel_mm:g} mm"
        following = abs(out[2] - motor) / DEGREE
        if following > limits.pump_following_deg:
            return f"the pump is {following:.0f} deg behind its command, limit {limits.pump_following_deg:g} deg"
        # Before the command phase the arm must stay where the reference begins.
        wanted = out[1] if self._tracked else 0.0
        if out[0] <= (COMMAND_PHASE if self._tracked else REST_PHASE):
            error = abs(wanted - arm) / DEGREE
            if error > limits.tracking_deg:
                return f"tracking error {error:.1f} deg, limit {limits.tracking_deg:g} deg"
        silent = self._silence.check(self._sample, out[0], out[2] / DEGREE, travel, angle, one, two)
        return silent or self._speeds(missed, angle, travel)

    def clipped(self, beyond: tuple[str, float] | None, outputs: Mapping[str, Output]) -> str | None:
        """Return why an output that was asked for more than its range stops the test; ``beyond`` is that of the tasks."""
        if beyond is None:
            self._clipped = 0
            return None
        self._clipped += 1
        name, asked = beyond
        allowed = self.limits.output_clipped_ms
        if self._clipped * PERIOD * 1e3 <= allowed:
            return None
        there = f"{outputs[name].lowest_v:g} to {outputs[name].highest_v:g} V"
        return f"output {name} is clipped: {asked:.2f} V asked, {there} there, limit output_clipped_ms {allowed:g} ms"

    def _speeds(self, missed: int, angle: float, travel: float) -> str | None:
        limits = self.limits
        self._sample += 1 + missed
        if len(self._past) == SPEED_SAMPLES:
            then, angle_then, travel_then = self._past[0]
            span = (self._sample - then) * PERIOD
            if abs(angle - angle_then) > limits.arm_speed_deg_per_s * span:
                speed = abs(angle - angle_then) / span
                return f"arm speed {speed:.0f} deg/s, limit {limits.arm_speed_deg_per_s:g} deg/s"
            if abs(travel - travel_then) > limits.pump_speed_mm_per_s * span:
                speed = abs(travel - travel_then) / span
                return f"pump speed {speed:.1f} mm/s, limit {limits.pump_speed_mm_per_s:g} mm/s"
        self._past.append((self._sample, angle, travel))
        return None


def limit_check(config: Mapping[str, Any], wiring: Wiring) -> LimitCheck:
    """Return the limits of one test."""
    one, two = wiring.pressures["pressure1"], wiring.pressures["pressure2"]
    voltages = ((one.lowest_v, one.highest_v), (two.lowest_v, two.highest_v))
    tracked = find_controller(config["controller"]["name"]).uses_arm
    lead = config["pump"]["lead_mm_per_rev"] * 1e-3
    return LimitCheck(read_limits(config), lead, voltages, coupling_of(config), tracked)
