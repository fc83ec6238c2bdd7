"""What every trajectory is: parameters, a duration, and an analytic reference."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import ClassVar, dataclass_transform

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hjcamp.errors import UsageError, shown
from hjcamp.model.declare.parameter import finite_number

Array = NDArray[np.float64]
Motion = tuple[Array, Array, Array]
LONGEST_DURATION = 3600.0
LARGEST = 1e9
# Half a hundred turns of an axis or of its motor; no motion is faster than half the sampling rate.
RANGES = {"deg": (-18000.0, 18000.0), "hz": (1e-4, 500.0), "s": (1e-3, LONGEST_DURATION)}
UNITS = {"deg": "deg", "hz": "hz", "time": "s"}


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(field,))
@dataclass(frozen=True, kw_only=True)
class Trajectory:
    """A desired motion that starts at 0 rad at time 0.

    A kind is a subclass in a file of its own: its annotated attributes are the parameters of the configuration (unit in
    the name, seconds where there is none), and ``motion`` is the law. Parameters that are named ``duration`` or end in
    ``_time``, ``_hz`` or ``_deg`` have the ranges of `check_number`; anything else raises `UsageError`.
    """

    kind: ClassVar[str] = ""
    duration: float

    def __init_subclass__(cls) -> None:
        cls.kind = cls.__module__.rpartition(".")[2]
        dataclass(frozen=True, kw_only=True)(cls)

    def __post_init__(self) -> None:
        for parameter in fields(self):
            if parameter.init and parameter.type in ("float", float):
                name = parameter.name
                unit = "s" if name in ("duration", "time") else UNITS.get(name.rpartition("_")[2], "")
                object.__setattr__(self, name, check_number(f"trajectory.{name}", getattr(self, name), unit))
        self.check()
        if self.duration > LONGEST_DURATION:
            raise UsageError(f"trajectory.duration is {self.duration:g} s; at most {LONGEST_DURATION:g} s are allowed")

    def check(self) -> None:
        """Raise `UsageError` where parameters do not fit together; each kind may add its own rule."""

    def motion(self, time: Array) -> Motion:
        """Return angle (rad), velocity (rad/s) and acceleration (rad/s^2) at ``time`` (s) within [0, duration]."""
        raise NotImplementedError

    @property
    def first_direction(self) -> float:
        """+1.0 or -1.0: the direction of the first motion (+1.0 where nothing moves)."""
        return -1.0 if getattr(self, "amplitude_deg", 0.0) < 0.0 else 1.0

    @property
    def end_of_motion(self) -> float:
        """Time in s after which the reference stays where it is."""
        return self.duration

    def reference(self, time: ArrayLike) -> Motion:
        """Return the desired angle (rad), velocity (rad/s) and acceleration (rad/s^2).

        ``time`` is in s, of any shape; the three answers have its shape. Before 0 s the reference is 0, after the
        duration it holds its last angle. At a corner the velocity is the one after the corner.
        """
        instants = np.asarray(time, dtype=np.float64)
        angle, velocity, acceleration = self.motion(np.clip(instants, 0.0, self.duration))
        moving = (instants >= 0.0) & (instants < self.duration)
        return (
            np.where(instants >= 0.0, angle, 0.0),
            np.where(moving, velocity, 0.0),
            np.where(moving, acceleration, 0.0),
        )


def check_number(name: str, value: object, unit: str = "") -> float:
    """Return ``value`` as a float; `UsageError` where it is no number within the range of its ``unit``.

    ``unit`` is ``deg``, ``hz``, ``s`` (more than a sample, less than an hour), or empty for any other number.
    """
    low, high = RANGES.get(unit, (-LARGEST, LARGEST))
    number = finite_number(value)
    if number is None or not low <= number <= high:
        raise UsageError(f"{name} is {shown(value)}; a number from {low:g} to {high:g} is needed")
    return number


def check_rise(rise_time: float, duration: float) -> None:
    """Raise `UsageError` where the test would end before its motion does."""
    if duration < rise_time:
        raise UsageError(f"trajectory.duration is {duration:g} s, shorter than trajectory.rise_time, {rise_time:g} s")
