"""The device behind a virtual serial line: a plant whose outputs a watchdog makes safe, and faults that can be switched on."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from hjcamp.backends.plant_simulation import plant_in
from hjcamp.backends.virtual_rig.faults import Fault
from hjcamp.backends.virtual_rig.stepping import VirtualPlant
from hjcamp.errors import HjcampError
from hjcamp.model.declare.plant import Plant
from hjcamp.rigs.fit import Wiring, channels_of_plant, wired
from hjcamp.rigs.protocol import ERROR, HELLO, READ, SAFE, SAMPLE, VERSION, WRITE, BadLine, message, numbers, parts_of
from hjcamp.rigs.rig import Rig

TICK_S = 2e-3
MISSED = 10
LATE_S = 5.0


def wiring_of_plant(plant: type[Plant]) -> Wiring:
    """Return the wiring of a rig that has what the plant has, under its names and in its units."""
    own = type("Own", (Rig,), {"channels": channels_of_plant(plant)})
    return wired(own, plant)


def sensed(plant: VirtualPlant, wiring: Wiring, outputs: Sequence[float]) -> list[float]:
    """Go on to the next sample under ``outputs``; return what a driver with this wiring reads, in its order, units and signs."""
    seen = plant.advance({one.name: value / one.scale for one, value in zip(wiring.given, outputs, strict=True)})
    told = [float(value * one.scale) for one, value in zip(wiring.measured, seen, strict=True)]
    told += [plant.plant.inputs[one.name].default * one.scale for one in wiring.read]
    return [told[wiring.order.index(place)] for place in range(len(told))]


class LineClosed(Exception):  # noqa: N818 - it is a state of the line
    """The device's end of the line is closed."""


class VirtualDevice:
    """A plant as a microcontroller has it. Without ``rate`` a read is the next sample; with it the plant's time passes by itself.

    ``written`` keeps (sample, inputs) of every change of an output, ``trips`` (sample of the last write, sample of the trip) of the
    watchdog, so that a test can see when the rig was safe; ``report`` is told of each trip. Names and numbers are those of the
    channels of ``wiring``; without it fields and inputs of the plant, in the units of the fields.
    """

    def __init__(
        self,
        config: Mapping[str, Any],
        faults: Iterable[Fault] = (),
        rate: float | None = None,
        watchdog_s: float = 0.05,
        token: str = "",
        report: Callable[[str], None] = lambda text: None,
        wiring: Wiring | None = None,
    ) -> None:
        plant = plant_in(config)
        self.plant, self.faults, self.rate, self.token = plant, list(faults), rate, token
        self.wiring = wiring or wiring_of_plant(plant)
        self.measured = [one.name for one in self.wiring.readings]
        self.given = [one.channel.name for one in self.wiring.given]
        self.watchdog = max(round(watchdog_s / plant.period), 1)
        self.lock = threading.RLock()
        self.written: list[tuple[int, tuple[float, ...]]] = []
        self.trips: list[tuple[int, int]] = []
        self.tests = 0
        self._config, self._report = config, report
        self._edge = threading.Condition(self.lock)
        self._closed = threading.Event()
        self._plant: VirtualPlant | None = None
        self._welcome = False
        self.arrange(1)
        self.tests = 0
        if rate is not None:
            threading.Thread(target=self._tick, name="virtual rig", daemon=True).start()

    @property
    def safe(self) -> tuple[float, ...]:
        """The safe state of the outputs."""
        return (0.0,) * len(self.given)

    @property
    def sample(self) -> int:
        """The number of the present sample."""
        return self._plant.sample if self._plant is not None else -1

    def arrange(self, seed: int) -> None:
        """Put the plant to the start of a test; outputs are safe."""
        plant = VirtualPlant(self._config, seed)
        with self.lock:
            self._plant, self.tests = plant, self.tests + 1
            self.outputs, self._tripped, self._read_at = self.safe, False, -1
            self.last_write: int | None = None
            self.written, self.trips = [], []
            self._done: set[str] = set()
            self._seen: list[float] = []
            self._advance()
            self._began = time.monotonic()

    def close(self) -> None:
        """End the thread that keeps the time."""
        self._closed.set()

    def due(self, kind: str) -> bool:
        """Return whether a fault is present now."""
        return any(one.kind == kind and one.test in (0, self.tests) and self.sample >= one.sample for one in self.faults)

    def once(self, kind: str) -> bool:
        """Return whether a fault that comes once comes now."""
        if kind in self._done or not self.due(kind):
            return False
        self._done.add(kind)
        return True

    def answer(self, line: bytes) -> bytes:
        """Return what the device answers to a line, nothing where it says nothing; raises ``LineClosed``."""
        with self.lock:
            self.catch_up()
            if self.due("gone"):
                raise LineClosed
            if self.due("silent"):
                return b""
            try:
                word, *parts = parts_of(line)
                if self.due("refuses") and word != HELLO:
                    return message(ERROR, "sensor supply lost")
                return self._answers(word, parts)
            except BadLine as problem:
                return message(ERROR, str(problem))
            except HjcampError as problem:
                return message(ERROR, str(problem))

    def _answers(self, word: str, parts: list[str]) -> bytes:
        if word == HELLO:
            return self._greet(parts)
        if not self._welcome:
            return message(ERROR, "greet the device first")
        if word == READ:
            return self._sample()
        if word == WRITE:
            return self._write(numbers(parts))
        if word == SAFE:
            self._set(self.safe)
            self.last_write, self._tripped = None, False
            return message(SAFE)
        return message(ERROR, f"unknown message {word[:8]}")

    def _greet(self, parts: list[str]) -> bytes:
        if len(parts) != 3 or parts[0] != VERSION or not parts[2].isdigit():
            return message(ERROR, f"expected {HELLO} {VERSION} TOKEN SEED")
        if self.token and parts[1] != self.token:
            self._welcome = False
            return message(ERROR, "wrong token")
        self._welcome = True
        self.arrange(int(parts[2]) % 2**63)
        period = self.plant.period
        return message(HELLO, VERSION, period, self.watchdog * period, str(len(self.measured)), *self.measured, *self.given)

    def _write(self, values: list[float]) -> bytes:
        if self._tripped:
            return message(ERROR, "the watchdog has tripped")
        if len(values) != len(self.given):
            return message(ERROR, f"{len(values)} values; {len(self.given)} are needed")
        if not all(abs(one) < 1e300 for one in values):
            return message(ERROR, "a value that is no number")
        self._set(tuple(values))
        self.last_write = self.sample
        return b""

    def _sample(self) -> bytes:
        ahead = MISSED if self.once("late_samples") else 0
        self._wait_for(self._read_at + 1 + ahead)
        self._read_at = self.sample
        if self.once("late"):
            self._sleep(LATE_S)
        values = list(self._seen)
        if self.due("nan"):
            values[0] = float("nan")
        if self.due("range_end"):
            values[0] = 1e12
        if self.due("short"):
            values.pop()
        answer = message(SAMPLE, str(self.sample), *values)
        return answer.replace(b"*", b"0*") if self.due("garbled") else answer

    def _sleep(self, seconds: float) -> None:
        # The line is late; the device's own time goes on.
        until = time.monotonic() + seconds
        while time.monotonic() < until and not self._closed.is_set():
            self._edge.wait(TICK_S)
            self.catch_up()

    def _wait_for(self, sample: int) -> None:
        while self.sample < sample and not self._closed.is_set():
            if self.rate is None:
                self._advance()
                continue
            self._edge.wait(max(self._began + sample * self.plant.period / self.rate - time.monotonic(), 1e-5))
            self.catch_up()

    def catch_up(self) -> None:
        """Bring the plant to the present; nothing in lockstep."""
        with self.lock:
            if self.rate is None:
                return
            present = int((time.monotonic() - self._began) * self.rate / self.plant.period)
            while self.sample < present:
                self._advance()

    def _tick(self) -> None:
        while not self._closed.wait(TICK_S):
            try:
                self.catch_up()
            except HjcampError as problem:
                self._report(str(problem))
                return

    def _advance(self) -> None:
        assert self._plant is not None
        seen = sensed(self._plant, self.wiring, self.outputs)
        self._seen = [self._seen[0], *seen[1:]] if self._seen and self.due("stuck") else seen
        if self.last_write is not None and self.sample - self.last_write >= self.watchdog:
            self.trips.append((self.last_write, self.sample))
            self._report(
                f"sample {self.sample}: the watchdog has tripped, {self.sample - self.last_write} samples after the last write"
            )
            self._set(self.safe)
            self.last_write, self._tripped = None, True

    def _set(self, values: tuple[float, ...]) -> None:
        if values != self.outputs:
            self.written.append((self.sample, values))
        self.outputs = values
