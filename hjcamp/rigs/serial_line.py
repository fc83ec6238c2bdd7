"""A rig on a serial line that speaks the text protocol of docs/rig_protocol.md, such as a microcontroller."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import ClassVar

from hjcamp.errors import HjcampError, UsageError, shown
from hjcamp.rigs.line import Line, open_line
from hjcamp.rigs.protocol import ERROR, HELLO, READ, SAFE, SAMPLE, VERSION, WRITE, BadLine, message, numbers, parts_of
from hjcamp.rigs.rig import Rig

OPEN_S = 4.0  # a board that resets when its port is opened takes two seconds
AGAIN_S = 0.5


class SerialRig(Rig):
    """A device on a serial line; a rig derived from it names ``port`` and ``channels``, which the device must name in the same order.

    The device keeps the time (its period must be the plant's) and has a watchdog of its own: it makes its outputs safe where no
    message has come for as long as it said when it was greeted.
    """

    port: ClassVar[str] = ""
    baud: ClassVar[int] = 115200
    token: ClassVar[str] = "-"
    says_at_open = True
    paced = True
    period: float = 0.0
    _line: Line | None = None

    def identity(self) -> str:
        """Return the port."""
        return f"serial {self.port}"

    def facts(self) -> str:
        """Return the port and what the device said of itself."""
        return f"{self.port}, watchdog {self.watchdog_s or 0.0:g} s"

    def open(self) -> None:
        """Greet the device until it answers; what it measures and takes must be our channels."""
        if not self.port or not isinstance(self.port, str):
            raise UsageError(f"rig '{self.name}': port is {shown(self.port)}; such as '/dev/ttyACM0' or 'COM3' is needed")
        until = time.monotonic() + OPEN_S
        try:
            self._line = open_line(self.port, self.baud, OPEN_S)
        except OSError as error:
            raise HjcampError(f"{self.port} cannot be opened: {error.strerror or error}") from None
        while True:
            try:
                self._line.write(message(HELLO, VERSION, self.token, str(self.seed)))
                told = self._answer(HELLO, min(time.monotonic() + AGAIN_S, until))
                break
            except (TimeoutError, BadLine) as error:
                if time.monotonic() >= until:
                    raise HjcampError(f"{self.port}: nothing speaks the protocol there within {OPEN_S:g} s ({error})") from None
        self._compare(told)

    def _compare(self, told: list[str]) -> None:
        try:
            version, period, watchdog, counted = told[0], float(told[1]), float(told[2]), int(told[3])
            measured, given = told[4 : 4 + counted], told[4 + counted :]
        except (ValueError, IndexError):
            raise HjcampError(f"{self.port}: a greeting that cannot be read: {' '.join(told)[:80]}") from None
        if version != VERSION:
            raise HjcampError(f"{self.port}: the device speaks version {version[:8]} of the protocol; {VERSION} is needed")
        for what, theirs, ours in (("measures", measured, self.measured), ("takes", given, self.given)):
            names = [one.name for one in ours]
            if theirs != names:
                told_there = ", ".join(theirs)[:200] or "nothing"
                raise UsageError(f"{self.port}: the device {what} {told_there}; the rig says {', '.join(names)}")
        self.period, self.watchdog_s = period, watchdog or None

    def read(self) -> Sequence[float]:
        """Return the next sample."""
        line = self._open()
        line.write(message(READ))
        found = numbers(self._answer(SAMPLE, time.monotonic() + self.deadline_s))
        if not found:
            raise BadLine("a sample without its number")
        self.sample = int(found[0])
        return found[1:]

    def write(self, values: Sequence[float]) -> None:
        """Send the inputs; that the device refuses them is said by its next answer."""
        self._open().write(message(WRITE, *(float(one) for one in values)))

    def safe(self) -> None:
        """Tell the device to make its outputs safe, and wait until it says so."""
        line = self._open()
        line.write(message(SAFE))
        until = time.monotonic() + self.deadline_s
        while True:
            try:
                parts = parts_of(line.read_line(until))
            except BadLine:
                continue
            if parts[0] == SAFE:
                return

    def close(self) -> None:
        """Let the port go."""
        if self._line is not None:
            self._line.close()
            self._line = None

    def _open(self) -> Line:
        if self._line is None:
            raise OSError(f"{self.port} is not open")
        return self._line

    def _answer(self, word: str, until: float) -> list[str]:
        parts = parts_of(self._open().read_line(until))
        if parts[0] == ERROR:
            raise HjcampError(f"the device says: {' '.join(parts[1:])[:200]}")
        if parts[0] != word:
            raise BadLine(f"'{parts[0][:8]}' came where '{word}' was asked for")
        return parts[1:]
