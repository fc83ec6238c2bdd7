"""Calls of a user's driver, each with a deadline: they run in a thread that is abandoned where one does not return."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Sequence
from typing import Any

from hjcamp.errors import HjcampError, counted, shown, text_of
from hjcamp.model.files.user_file import file_of, line_in
from hjcamp.rigs.rig import Rig

SETUP_S = 5.0  # opening and closing take longer than using


class DriverFailed(HjcampError):  # noqa: N818 - it is a state of the driver
    """A call of the driver raised, or did not return in time."""


class Caller:
    """A thread that makes one call after the other for another thread."""

    def __init__(self) -> None:
        self.stuck = ""
        self._asked, self._answered = threading.Lock(), threading.Lock()
        self._asked.acquire()
        self._answered.acquire()
        self._call: Callable[[], Any] | None = None
        self._value: Any = None
        self._problem: BaseException | None = None
        threading.Thread(target=self._work, name="driver of the rig", daemon=True).start()

    def call(self, what: str, call: Callable[[], Any], within: float) -> Any:
        """Return what ``call`` does; raises what it raises, and ``DriverFailed`` where it does not return within so many seconds."""
        if self.stuck:
            raise DriverFailed(f"{what} was not called: {self.stuck} has not returned")
        self._call = call
        self._asked.release()
        if not self._answered.acquire(timeout=within):
            self.stuck = what
            raise DriverFailed(f"{what} did not return within {within:g} s")
        problem, value = self._problem, self._value
        if problem is not None:
            self._problem = None
            raise problem
        return value

    def end(self) -> None:
        """Let the thread end; one that is stuck ends with the process."""
        if not self.stuck:
            self._call = None
            self._asked.release()

    def _work(self) -> None:
        while True:
            self._asked.acquire()
            call = self._call
            if call is None:
                return
            try:
                self._value = call()
            except BaseException as problem:
                self._problem = problem
            self._answered.release()


class Driver:
    """A rig's calls as the loop makes them; whatever goes wrong is one ``DriverFailed`` that says where."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.is_safe = True
        self.last: tuple[float, ...] = ()
        self._caller = Caller()

    def open(self) -> None:
        """Reach the device."""
        self._made("open", self.rig.open, SETUP_S)

    def read(self, wait: float) -> list[float]:
        """Return the numbers of the next sample, one for each channel that is read; it may be ``wait`` s away."""
        values = self._made("read", self.rig.read, self.rig.deadline_s + wait)
        needed = len(self.rig.measured)
        try:
            found = [float(one) for one in values]
        except (TypeError, ValueError):
            raise DriverFailed(f"read() gave {shown(values)}; {counted(needed, 'number is', 'numbers are')} needed") from None
        if len(found) != needed:
            names = ", ".join(one.name for one in self.rig.measured)
            raise DriverFailed(f"read() gave {len(found)} values; {needed} are needed: {names}")
        return found

    def write(self, values: Sequence[float]) -> None:
        """Give the inputs their numbers."""
        self.is_safe = False
        self.last = tuple(values)
        self._made("write", lambda: self.rig.write(values), self.rig.deadline_s)

    def make_safe(self) -> str | None:
        """Make the outputs safe, from another thread where the driver is stuck; return what prevented it, else None."""
        problem = ""
        for _ in range(2):
            if self._caller.stuck:
                self._caller = Caller()
            try:
                self._made("safe", self.rig.safe, self.rig.deadline_s)
            except DriverFailed as error:
                problem = str(error)
            else:
                self.is_safe = True
                return None
        return f"{problem}; last written: {self.last_written()}"

    def last_written(self) -> str:
        """Return every input with what was last written to it."""
        told = zip(self.rig.given, self.last, strict=False)
        return ", ".join(f"{one.name} {value:.4g} {one.unit}".rstrip() for one, value in told) or "nothing"

    def close(self) -> None:
        """Let the device go; never raises."""
        if not self._caller.stuck:
            with contextlib.suppress(DriverFailed):
                self._made("close", self.rig.close, SETUP_S)
        self._caller.end()

    def _made(self, what: str, call: Callable[[], Any], within: float) -> Any:
        try:
            return self._caller.call(f"{what}()", call, within)
        except DriverFailed:
            raise
        except BaseException as problem:
            file = file_of(type(self.rig).__module__)
            line = line_in(file, problem) if file else None
            where = f" ({file}: line {line})" if line else ""
            kind = "" if isinstance(problem, HjcampError) else f"{type(problem).__name__}: "
            raise DriverFailed(f"{what}() failed: {kind}{text_of(problem)}{where}") from problem


def not_written(driver: Driver, problem: str) -> str:
    """Return what to say where the outputs could not be made safe, and what does it without us."""
    rig = driver.rig
    watchdog = (
        "The device has no watchdog" + (f"; interlock: {rig.interlock}" if rig.interlock else "")
        if rig.watchdog_s is None
        else f"The device's watchdog makes them safe {rig.watchdog_s * 1e3:g} ms after the last write"
    )
    return f"THE OUTPUTS COULD NOT BE WRITTEN ({problem}): switch the drives off by hand. {watchdog}"


def last_words(driver: Driver) -> str:
    """Return what is known of the outputs while the program is stuck."""
    return "The outputs are safe" if driver.is_safe else not_written(driver, f"last written: {driver.last_written()}")
