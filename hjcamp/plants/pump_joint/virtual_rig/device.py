"""The virtual device: terminals in volts and counts, a sample clock, a watchdog, and the faults."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.rig.wiring import Wiring, read_wiring
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault
from hjcamp.plants.pump_joint.virtual_rig.plant import READINGS, VirtualPlant
from hjcamp.plants.pump_joint.virtual_rig.sessions import NO_SUCH_TASK, DeviceError, Tasks

DEVICE_GONE = -201003
READ_FAILED = -200361
READ_TIMED_OUT = -200284
WATCHDOG_EXPIRED = -200678
NOT_ARRANGED = -200088
SWING_V = 0.2
IDLE_S = 2.0  # a client that is silent for so long is no longer there
STEPS_MISSED = {"late_samples": 5, "one_late_sample": 1}
PERIOD_S = 1e-3
TICK_S = 5e-3


@dataclass
class Watchdog:
    """The device's own timer, in samples: unless reset in time it puts the outputs into their safe state."""

    samples: int
    states: dict[str, float] = field(default_factory=dict)
    running: bool = False
    last_reset: int = 0
    expired: bool = False

    def due(self, sample: int) -> bool:
        """Return whether it trips at this sample."""
        return self.running and not self.expired and sample - self.last_reset >= self.samples


class VirtualDevice:
    """A data acquisition device whose terminals are wired to a virtual plant.

    Without ``rate`` time is lockstep: a read of the analog inputs is the next edge of the sample clock. With it the
    plant's time passes by itself, ``rate`` seconds for each second of the wall clock: every call meets the plant as it
    is by then, and between calls a thread keeps it up to date. ``written`` keeps (sample, channel, volts) of every
    change of an output, ``trips`` (sample of the last reset, sample of the trip) of the watchdog, so that a test can see
    when the rig was safe; ``report`` is told of each trip.
    """

    def __init__(
        self,
        faults: Iterable[Fault] = (),
        hidden: Mapping[str, Mapping[str, float]] | None = None,
        rate: float | None = None,
        report: Callable[[str], None] = lambda text: None,
    ) -> None:
        self.faults = list(faults)
        self.hidden = dict(hidden or {})
        self.lock = threading.RLock()
        self.tests = 0
        self.plant: VirtualPlant | None = None
        self.wiring: Wiring | None = None
        self.gone = False
        self.tasks = Tasks()
        self.owner = ""
        self.rate: float | None = None
        self._report = report
        self._last_call = float("-inf")
        self._edge = threading.Condition(self.lock)
        self._closed = threading.Event()
        self._ticker: threading.Thread | None = None
        self._began = 0.0
        self._clear()
        if rate is not None:
            self.run_by_itself(rate)

    def _clear(self) -> None:
        self.samples = 0
        self.volts: dict[str, float] = {}
        self.inputs: dict[str, float] = {}
        self.written: list[tuple[int, str, float]] = []
        self.trips: list[tuple[int, int]] = []
        self.watchdog: Watchdog | None = None
        self.read_at = 0
        self._counter_start: dict[str, int] = {}
        self._done: set[str] = set()

    def arrange(self, config: Mapping[str, Any], seed: int, owner: str = "") -> None:
        """Put the joint of one test on the bench: hardware, payload and wiring as configured, everything at rest.

        Refused while another client is at work; what a dead client left is cleared.
        """
        if owner != self.owner and time.monotonic() - self._last_call < IDLE_S:
            raise HjcampError("another client is at work on this virtual rig")
        # What is refused leaves everything as it was: the clock of the rig goes on.
        wiring, plant = read_wiring(config), VirtualPlant(config, seed, self.hidden)
        with self.lock:
            self.owner = owner
            self._last_call = time.monotonic()
            self.tasks = Tasks()
            self._clear()
            self.tests += 1
            self.gone = False
            self.wiring, self.plant = wiring, plant
            self.volts = {output.channel: 0.0 for output in wiring.outputs.values()}
            self._began = time.monotonic()

    def run_by_itself(self, rate: float | None) -> None:
        """Let time pass from now on, ``rate`` seconds of the plant for each of the wall clock; None: in lockstep again."""
        with self.lock:
            self.rate = rate
            if rate is None:
                return
            self._began = time.monotonic() - self.samples * PERIOD_S / rate
            if self._ticker is None:
                self._ticker = threading.Thread(target=self._tick, name="virtual rig", daemon=True)
                self._ticker.start()

    def close(self) -> None:
        """End the thread that keeps the time."""
        self._closed.set()
        if self._ticker is not None:
            self._ticker.join()

    def catch_up(self) -> None:
        """Bring the plant to the present; nothing in lockstep."""
        with self.lock:
            if self.rate is None or self.plant is None:
                return
            present = int((time.monotonic() - self._began) * self.rate / PERIOD_S)
            while self.samples < present and not self.gone:
                self._step()

    def _tick(self) -> None:
        while not self._closed.wait(TICK_S):
            self.catch_up()

    def called(self) -> None:
        """Note that a client is at work."""
        self._last_call = time.monotonic()

    def clock(self) -> None:
        """Wait for the next edge of the sample clock that was not read yet, and latch all inputs."""
        self.alive()
        ahead = 1
        for kind in self._due():
            if kind in STEPS_MISSED and kind not in self._done:
                self._done.add(kind)
                ahead += STEPS_MISSED[kind]
            if kind == "error_code":
                raise DeviceError(READ_FAILED, "Onboard device memory overflow.")
            if kind == "clock_stopped":
                raise DeviceError(READ_TIMED_OUT, "Some or all of the samples requested have not yet been acquired.")
        self._wait_for(self.read_at + ahead)
        self.alive()
        self.read_at = self.samples

    def _wait_for(self, sample: int) -> None:
        test = self.tests
        self.catch_up()
        while self.samples < sample and not self.gone:
            if self.rate is None:
                self._step()
                continue
            self._edge.wait(max(0.0, self._began + sample * PERIOD_S / self.rate - time.monotonic()))
            if self.tests != test:
                raise DeviceError(NO_SUCH_TASK, "The task was aborted: another client has taken the rig over.")
            self.catch_up()

    def write(self, channel: str, volts: float) -> None:
        """Set an analog output; it takes effect at once, which is the beginning of the present sample."""
        self.alive()
        if self.watchdog is not None and self.watchdog.expired:
            raise DeviceError(WATCHDOG_EXPIRED, "Write failed because the watchdog timer expired.")
        self._set(channel, volts)

    def alive(self) -> None:
        """Raise the driver's error where the device is not there."""
        if self.gone:
            raise DeviceError(DEVICE_GONE, "Device cannot be accessed: it is no longer present in the system.")
        if self.plant is None:
            raise DeviceError(NOT_ARRANGED, "There is no joint on the virtual bench.")

    def counts(self, name: str) -> int:
        """Return the present count of an encoder (``arm``, ``pump``) since its task started."""
        return round(self.inputs.get(name, 0.0)) - self._counter_start.get(name, 0)

    def zero(self, name: str, initial: int) -> None:
        """Start a counter at ``initial`` where its encoder stands now."""
        self._counter_start[name] = round(self.inputs.get(name, 0.0)) - initial

    def _set(self, channel: str, volts: float) -> None:
        if self.volts.get(channel) != volts:
            self.written.append((self.samples, channel, volts))
        self.volts[channel] = volts

    def _vanish(self) -> None:
        # A watchdog trips when the device loses its computer; without one the outputs fall to 0 V.
        states = self.watchdog.states if self.watchdog is not None else dict.fromkeys(self.volts, 0.0)
        for channel, volts in states.items():
            self._set(channel, volts)
        self.gone = True

    def _trip(self, watchdog: Watchdog) -> None:
        watchdog.expired = True
        for channel, volts in watchdog.states.items():
            self._set(channel, volts)
        self.trips.append((watchdog.last_reset, self.samples))
        outputs = ", ".join(f"{channel} {volts:.4g} V" for channel, volts in self.volts.items())
        self._report(
            f"sample {self.samples}: the watchdog has tripped, {self.samples - watchdog.last_reset} samples after its "
            f"last reset; outputs: {outputs}"
        )

    def _due(self) -> list[str]:
        return [one.kind for one in self.faults if one.test in (0, self.tests) and self.samples >= one.sample]

    def _step(self) -> None:
        assert self.plant is not None and self.wiring is not None
        wiring, due = self.wiring, self._due()
        if "device_gone" in due:
            self._vanish()
            return
        if "burst_line" in due:
            self.plant.burst(1)
        self.samples += 1
        watchdog = self.watchdog
        if watchdog is not None and watchdog.due(self.samples):
            self._trip(watchdog)
        seen = dict(zip(READINGS, self.plant.advance(np.array(wiring.physical_outputs(self.volts))), strict=True))
        latched = {
            "arm": wiring.encoders["arm"].sign * round(seen["arm_deg"] / self.plant.count("arm_deg")),
            "pump": wiring.encoders["pump"].sign * round(seen["pump_deg"] / self.plant.count("pump_deg")),
            "pressure1": wiring.pressures["pressure1"].volts(seen["pressure1_mpa"]),
            "pressure2": wiring.pressures["pressure2"].volts(seen["pressure2_mpa"]),
        }
        for kind in self._due():
            distort(kind, latched, self.inputs, self.samples, wiring)
        self.inputs = latched


def distort(kind: str, latched: dict[str, float], before: dict[str, float], sample: int, wiring: Wiring) -> None:
    """Change what was latched (volts, counts) as a broken sensor would."""
    sensor, counts = wiring.pressures["pressure1"], wiring.encoders
    if kind == "swapped_pressures":
        latched["pressure1"], latched["pressure2"] = latched["pressure2"], latched["pressure1"]
    elif kind == "reversed_encoder":
        latched["arm"] = -latched["arm"]
    elif kind == "stuck_encoder":
        latched["arm"] = before.get("arm", 0.0)
    elif kind == "stuck_pump_encoder":
        latched["pump"] = before.get("pump", 0.0)
    elif kind == "lost_sensor":
        latched["pressure1"] = 0.0
    elif kind == "noisy_sensor":
        latched["pressure1"] += SWING_V * (1 if sample % 2 else -1)
    elif kind == "pressure_spike":
        latched["pressure1"] += 0.8 / sensor.mpa_per_v
    elif kind == "pressure_drop":
        latched["pressure1"] = sensor.volts(-0.112e6)
    elif kind == "arm_jump":
        latched["arm"] += round(250 * math.pi / 180 / counts["arm"].count)
    elif kind == "pump_jump":
        latched["pump"] += round(10 * 2 * math.pi / counts["pump"].count)
