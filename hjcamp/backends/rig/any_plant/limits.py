"""The limits of any plant on a rig, checked on every sample: those of its channels, and what the plant finds plausible."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any

from hjcamp.controllers.fit import controlled_field
from hjcamp.errors import counted
from hjcamp.model.checks.watch import Term, Watch
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.rigs.fit import Wire, Wiring
from hjcamp.rigs.rig import Rig

SPEED_SAMPLES = 10
#: Of samples that were missed the log holds copies; how many is counted with them.
MISSED = "missed_samples"


@dataclass(frozen=True)
class Limit:
    """What one quantity must stay within, in the channel's unit: ``low`` to ``high``, and ``fastest`` per second."""

    wire: Wire
    low: float
    high: float
    fastest: float
    clipped: tuple[float, float]

    @property
    def name(self) -> str:
        """The quantity as people know it."""
        return self.wire.channel.name


def limits_of(wiring: Wiring) -> list[Limit]:
    """Return the limits of what is read and of the inputs, in this order: the narrower of the rig's and the plant's."""
    plant = wiring.plant
    return [_limit(plant, wire) for wire in (*wiring.measured, *wiring.read, *wiring.given)]


def _limit(plant: type[Plant], wire: Wire) -> Limit:
    known = {one.field: one.plausible for one in plant.channels} | {one.name: one.plausible for one in plant.measured.values()}
    known |= {name: one.plausible for name, one in plant.given_inputs().items()}
    own, scale = wire.channel.limits, abs(wire.scale)
    ends = known.get(wire.name, (-inf, inf))
    low, high = max(own[0], ends[0] * scale), min(own[1], ends[1] * scale)
    low_end, high_end = wire.channel.range
    return Limit(wire, low, high, wire.channel.fastest, (max(low, low_end), min(high, high_end)))


class PlantLimits:
    """Watches one test; ``check`` and ``clipped`` return the reason to stop, or None."""

    def __init__(self, rig: Rig, wiring: Wiring, tracked: bool) -> None:
        plant = wiring.plant
        found = limits_of(wiring)
        count = len(wiring.measured) + len(wiring.read)
        self.read, self.given = found[:count], found[count:]
        self.missed = 0
        self._rig, self._period = rig, plant.period
        self._clipped = 0
        self._sample = 0
        self._past: deque[tuple[int, list[float]]] = deque(maxlen=SPEED_SAMPLES)
        self._followed = [one.field for one in wiring.measured].index(controlled_field(plant)) if tracked else -1

    def check(self, missed: int, values: list[float], wanted: float | None) -> str | None:
        """Return why the rig must be made safe; ``values`` in the channels' units, ``wanted`` of what is controlled, SI."""
        if missed:
            self.missed += missed
            for number, allowed, words in (
                (missed, self._rig.missed_at_once, "at once"),
                (self.missed, self._rig.missed_in_all, "in all"),
            ):
                if number > allowed:
                    return f"{counted(number, 'sample was', 'samples were')} missed {words} (limit {allowed})"
        for value, limit in zip(values, self.read, strict=True):
            if not isfinite(value):
                return f"{limit.name} is lost: it reads {value}"
            low, high = limit.wire.channel.range
            if not low < value < high:
                return f"{limit.name} is lost: {_with_unit(value, limit)} is at an end of its range, {low:g} to {high:g}"
            if not limit.low <= value <= limit.high:
                side, end = ("below", limit.low) if value < limit.low else ("above", limit.high)
                return f"{limit.name} {_with_unit(value, limit)} is {side} {_with_unit(end, limit)}"
        if wanted is not None and self._followed >= 0:
            limit = self.read[self._followed]
            error = abs(wanted * abs(limit.wire.scale) - values[self._followed])
            if error > self._rig.tracking:
                return f"tracking error {_with_unit(error, limit)}, limit {_with_unit(self._rig.tracking, limit)}"
        return self._changes(missed, values)

    def _changes(self, missed: int, values: list[float]) -> str | None:
        self._sample += 1 + missed
        if len(self._past) == SPEED_SAMPLES:
            then, before = self._past[0]
            span = (self._sample - then) * self._period
            for value, past, limit in zip(values, before, self.read, strict=True):
                if abs(value - past) > limit.fastest * span:
                    return (
                        f"{limit.name} changes by {abs(value - past) / span:.3g} {limit.wire.unit}/s, limit {limit.fastest:g}"
                    )
        self._past.append((self._sample, values))
        return None

    def given_within(self, asked: list[float]) -> tuple[list[float], str | None]:
        """Return what the outputs give where ``asked`` (channels' units) is asked, and why an output that is clipped stops the test."""
        given = [min(max(value, one.clipped[0]), one.clipped[1]) for value, one in zip(asked, self.given, strict=True)]
        if given == asked:
            self._clipped = 0
            return given, None
        self._clipped += 1
        if self._clipped * self._period <= self._rig.clipped_s:
            return given, None
        value, one = next((value, one) for value, got, one in zip(asked, given, self.given, strict=True) if got != value)
        low, high = one.clipped
        there = f"{low:g} to {high:g} there, limit clipped_s {self._rig.clipped_s:g} s"
        return given, f"{one.name} is clipped: {_with_unit(value, one)} asked, {there}"


def plant_watches(rig: type[Rig] | Rig, wiring: Wiring, tracked: bool, reach: bool = False) -> list[Watch]:
    """Return the limits that a log can show, for who looks on; with ``reach`` the ranges of the channels count as well."""
    found = []
    for one in limits_of(wiring):
        factor = one.wire.channel.sign * one.wire.scale / abs(one.wire.scale)
        term = Term(one.wire.field, factor * _per_field(one.wire))
        low, high = (end if isfinite(end) else None for end in (one.clipped if reach else (one.low, one.high)))
        if low is not None or high is not None:
            found.append(Watch(one.wire.field, one.wire.unit, (term,), low, high))
        if isfinite(one.fastest):
            rate = term.factor / (SPEED_SAMPLES * wiring.plant.period)
            terms = (Term(one.wire.field, rate), Term(one.wire.field, -rate, SPEED_SAMPLES))
            found.append(Watch(f"{one.wire.field}_rate", f"{one.wire.unit}/s", terms, -one.fastest, one.fastest))
    if tracked and isfinite(rig.tracking):
        field = controlled_field(wiring.plant)
        wire = next(one for one in wiring.measured if one.field == field)
        scale = _per_field(wire)
        terms = (Term(f"reference_{field}", scale), Term(field, -scale))
        found.append(Watch("tracking", wire.unit, terms, -rig.tracking, rig.tracking, (3.0, 3.0)))
    found.append(Watch("missed_in_all", "samples", (Term(MISSED),), None, float(rig.missed_in_all)))
    return found


def _per_field(wire: Wire) -> float:
    """Return the channel's number for one of the field's unit."""
    return abs(wire.scale) / unit_of_field(wire.field, wire.name).scale


def _with_unit(value: float, limit: Limit) -> str:
    return f"{value:.4g} {limit.wire.unit}" if limit.wire.unit != "1" else f"{value:.4g}"


def told(rig: type[Rig] | Rig) -> Mapping[str, Any]:
    """Return all that a check of a rig rests on, by name."""
    own = {"plant": rig.plant, "watchdog_s": rig.watchdog_s, "tracking": str(rig.tracking), "clipped_s": rig.clipped_s}
    own |= {"missed_at_once": rig.missed_at_once, "missed_in_all": rig.missed_in_all, "deadline_s": rig.deadline_s}
    return {**own, "channels": {one.name: one.told() for one in rig.channels}}
