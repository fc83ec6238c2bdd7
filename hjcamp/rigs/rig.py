"""The base class of all rigs: how the sensors and inputs of a plant are reached, in one file of the user's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from math import inf, isfinite
from typing import Any, ClassVar

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.model.declare.parameter import finite_number
from hjcamp.model.files.docstring import docstring_sentence
from hjcamp.model.language.field_unit import FIELD_UNITS, FieldUnit

#: What a driver does; the loop calls nothing else.
CALLS = ("open", "read", "write", "safe", "close")


@dataclass(frozen=True)
class Channel:
    r"""One quantity of the plant on the rig: a measured field (``position_m``), or an input by its name (``voltage``).

    Numbers are in ``unit`` (a suffix of fields, such as ``mm``; that of the field unless given), per second for ``fastest``.

    .. math:: x = \mathrm{sign} \cdot y

    y is what the driver reads or is told, x the plant's quantity, of which all else is said. ``range`` is what sensor or output can
    show or give: a reading at or beyond its end is a lost sensor, a command beyond it is clipped. What passes ``limits``, or
    changes faster than ``fastest``, makes the rig safe. An output goes to ``safe`` when anything is wrong; the check puts it to
    ``nudge`` for ``nudge_s``. ``terminal``, ``scale`` (units for one volt or count) and ``offset`` are for converters alone.
    """

    name: str
    unit: str = ""
    range: tuple[float, float] = (-inf, inf)
    sign: int = 1
    limits: tuple[float, float] = (-inf, inf)
    fastest: float = inf
    safe: float = 0.0
    nudge: float = 0.0
    nudge_s: float = 0.2
    terminal: str = ""
    scale: float = 1.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        where = f"channel {shown(self.name)}"
        if not isinstance(self.name, str) or not self.name:
            raise UsageError(f"{where}: the name of a measured field or of an input is needed")
        if self.unit and self.unit not in FIELD_UNITS:
            raise unknown("unit", str(self.unit), FIELD_UNITS, where)
        if self.sign not in (1, -1) or isinstance(self.sign, bool):
            raise UsageError(f"{where}: sign is {shown(self.sign)}; 1 or -1 is needed")
        for word in ("range", "limits"):
            ends = getattr(self, word)
            if not (isinstance(ends, tuple) and len(ends) == 2 and all(_number(one) for one in ends) and ends[0] < ends[1]):
                raise UsageError(f"{where}: {word} is {shown(ends)}; a pair (lowest, highest) is needed")
        for word in ("safe", "nudge", "scale", "offset", "nudge_s"):
            if finite_number(getattr(self, word)) is None:
                raise UsageError(f"{where}: {word} is {shown(getattr(self, word))}; a finite number is needed")
        for word, low in (("fastest", self.fastest), ("nudge_s", self.nudge_s), ("scale", abs(self.scale))):
            if not _number(low) or low <= 0.0:
                raise UsageError(f"{where}: {word} is {shown(getattr(self, word))}; a number that is not 0 or below is needed")
        if not self.range[0] <= self.safe <= self.range[1]:
            raise UsageError(f"{where}: safe is {self.safe:g}, outside its range ({self.range[0]:g}, {self.range[1]:g})")

    def told(self) -> dict[str, Any]:
        """Return what a check of the rig rests on, as JSON keeps it: an end without a number is a word."""
        values = {one.name: getattr(self, one.name) for one in fields(self)}
        return {name: _plain(value) for name, value in values.items()}


class Rig:
    """A rig of one ``plant``; a subclass is one file: ``channels``, and what a driver does. The loop gives everything else.

    ``read`` returns one number for each channel that is measured, ``write`` takes one for each that is an input, in the order of
    ``channels``. Where ``paced`` the device keeps the time: ``read`` waits for its next sample, and may set ``sample`` to its
    number, so that samples that were missed are counted. Each call must return within ``deadline_s`` (opening and closing within
    5 s); a driver that does not is abandoned, and ``safe`` is called from another thread.

    ``watchdog_s`` is how long after the last write the device itself makes its outputs safe, None where it has no watchdog;
    ``interlock`` names the hardware that does so then. ``seed`` is that of the test in hand: virtual rigs draw from it.
    ``reads`` are inputs of the plant that this rig reads and does not command, such as a room's temperature.
    """

    name: ClassVar[str] = ""
    plant: ClassVar[str] = ""
    channels: ClassVar[tuple[Channel, ...]] = ()
    reads: ClassVar[tuple[str, ...]] = ()
    real: ClassVar[bool] = True
    #: Whether the device itself says, once it is opened, whether it has a watchdog.
    says_at_open: ClassVar[bool] = False
    paced: bool = False
    lockstep: bool = False
    watchdog_s: float | None = None
    interlock: str | None = None
    deadline_s: ClassVar[float] = 0.1
    missed_at_once: ClassVar[int] = 4
    missed_in_all: ClassVar[int] = 40
    clipped_s: ClassVar[float] = 0.0
    tracking: ClassVar[float] = inf
    sample: int | None = None
    seed: int = 1
    #: The channels that ``read`` gives and ``write`` takes, in order: set before ``open``.
    measured: tuple[Channel, ...] = ()
    given: tuple[Channel, ...] = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        channels = cls.channels
        if not isinstance(channels, tuple) or not all(isinstance(one, Channel) for one in channels):
            raise UsageError(f"{cls.__name__}: channels is {shown(channels)}; a tuple of Channel(...) is needed")
        names = [one.name for one in channels]
        for name in names:
            if names.count(name) > 1:
                raise UsageError(f"{cls.__name__}: two channels are called '{name}'")
        for word in ("deadline_s", "tracking"):
            if not _number(getattr(cls, word)) or getattr(cls, word) <= 0.0:
                raise UsageError(f"{cls.__name__}: {word} is {shown(getattr(cls, word))}; a number above 0 is needed")
        for word in CALLS:
            if not callable(getattr(cls, word)):
                raise UsageError(f"{cls.__name__}: '{word}' is {shown(getattr(cls, word))}; a method is needed")

    @classmethod
    def sentence(cls) -> str:
        """Return the first sentence of the docstring."""
        return docstring_sentence(cls)

    @classmethod
    def lacking(cls) -> list[str]:
        """Return the calls of a driver that this class does not have."""
        return [word for word in ("read", "write") if getattr(cls, word) is getattr(Rig, word)]

    def identity(self) -> str:
        """Return what names the hardware: two rigs of one identity exclude each other."""
        return f"rig {self.name}"

    def facts(self) -> str:
        """Return what the device says of itself, for the logs; asked after it was opened."""
        return ""

    def open(self) -> None:
        """Reach the device; nothing may move."""

    def read(self) -> Sequence[float]:
        """Return one number for each measured channel, in its unit."""
        raise UsageError(f"rig '{self.name}' has no read()")

    def write(self, values: Sequence[float]) -> None:
        """Give each input its number, in its unit."""
        raise UsageError(f"rig '{self.name}' has no write(values)")

    def safe(self) -> None:
        """Put the outputs into their safe state: by writing it, unless the device knows better."""
        self.write([one.sign * one.safe for one in self.given])

    def close(self) -> None:
        """Let the device go; never raises where it is gone."""


def unit_of(channel: Channel, usual: FieldUnit) -> FieldUnit:
    """Return the unit of a channel; ``UsageError`` for one that is not of the quantity whose ``usual`` unit is given."""
    if not channel.unit:
        return usual
    unit = FIELD_UNITS[channel.unit]
    if unit.si != usual.si:
        fitting = [suffix for suffix, one in FIELD_UNITS.items() if one.si == usual.si]
        raise unknown(f"unit of {usual.si}", channel.unit, fitting, f"channel '{channel.name}'")
    return unit


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value == value


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(one) for one in value]
    return value if not isinstance(value, float) or isfinite(value) else str(value)
