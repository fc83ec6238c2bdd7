"""Segments: moves and rests, one after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any, NamedTuple

import numpy as np

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.trajectories.base import Array, Motion, Trajectory, check_number
from hjcamp.trajectories.laws import LAWS, rise

ALLOWED = ("to_deg", "by_deg", "in", "law", "rest")


class Segment(NamedTuple):
    """One move or rest: start and length in s, start angle and travel in rad, law by name."""

    start: float
    length: float
    angle: float
    travel: float
    law: str


class Segments(Trajectory):
    """Moves ``{to_deg or by_deg, in: seconds, law: cycloid or linear}`` and rests ``{rest: seconds}`` in sequence.

    The law is cycloid where it is not given. The duration is the sum of the parts.
    Source: thesis 5.2.5, trajectory g.
    """

    segments: Sequence[Mapping[str, Any]]
    duration: float = field(init=False)

    def check(self) -> None:
        if isinstance(self.segments, (str, Mapping)) or not isinstance(self.segments, Sequence) or not self.segments:
            raise UsageError("trajectory.segments must be a list of at least one move or rest")
        parts: list[Segment] = []
        start, angle = 0.0, 0.0
        for number, item in enumerate(self.segments):
            part = read_segment(item, f"trajectory.segments[{number}]", start, angle)
            parts.append(part)
            start, angle = start + part.length, angle + part.travel
        object.__setattr__(self, "_parts", parts)
        object.__setattr__(self, "duration", start)

    @property
    def parts(self) -> list[Segment]:
        """The moves and rests with their start times and angles."""
        return self.__dict__["_parts"]

    def motion(self, time: Array) -> Motion:
        starts = np.array([part.start for part in self.parts])
        # A sample that falls on a start belongs to the part that begins there, whatever the rounding of the sum.
        owner = np.clip(np.searchsorted(starts, time + 1e-9, side="right") - 1, 0, len(starts) - 1)
        answer = tuple(np.zeros_like(time) for _ in range(3))
        for index, part in enumerate(self.parts):
            mine = owner == index
            since_start = np.maximum(time[mine] - part.start, 0.0)
            moved = rise(LAWS[part.law], since_start, part.length, part.travel)
            for target, values in zip(answer, moved, strict=True):
                target[mine] = values
            answer[0][mine] += part.angle
        return answer[0], answer[1], answer[2]

    @property
    def first_direction(self) -> float:
        travels = [part.travel for part in self.parts if part.travel]
        return -1.0 if travels and travels[0] < 0.0 else 1.0

    @property
    def end_of_motion(self) -> float:
        return max((part.start + part.length for part in self.parts if part.travel), default=0.0)


def read_segment(item: object, where: str, start: float, angle: float) -> Segment:
    """Return the part that one entry of the list describes; `UsageError` where it is neither move nor rest."""
    if not isinstance(item, Mapping):
        raise UsageError(f"{where} is {shown(item)}; a move {{to_deg, in, law}} or a rest {{rest}} is needed")
    for name in item:
        if name not in ALLOWED:
            raise unknown("parameter", str(name), ALLOWED, where)
    if "rest" in item:
        if len(item) > 1:
            raise UsageError(f"{where} has 'rest' with other parameters; a rest has nothing but its seconds")
        return Segment(start, check_number(f"{where}.rest", item["rest"], "s"), angle, 0.0, "linear")
    if ("to_deg" in item) == ("by_deg" in item):
        raise UsageError(f"{where} needs one of to_deg and by_deg")
    if "in" not in item:
        raise UsageError(f"{where} needs 'in', the seconds that the move takes")
    length = check_number(f"{where}.in", item["in"], "s")
    law = str(item.get("law", "cycloid"))
    if law not in LAWS:
        raise unknown("law", law, LAWS, where)
    if "to_deg" in item:
        travel = np.radians(check_number(f"{where}.to_deg", item["to_deg"], "deg")) - angle
    else:
        travel = np.radians(check_number(f"{where}.by_deg", item["by_deg"], "deg"))
    return Segment(start, length, angle, float(travel), law)
