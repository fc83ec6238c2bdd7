"""A rig of any plant on a converter of National Instruments: analog inputs and outputs in volts, encoders in counts."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from hjcamp.errors import HjcampError, UsageError
from hjcamp.rigs.rig import Channel, Rig

COUNTER = "ctr"


class DaqmxRig(Rig):
    """Terminals of NI-DAQmx: a channel's ``terminal`` is ``Dev1/ai0``, ``Dev1/ao0`` or, for an encoder, ``Dev1/ctr0``.

    A quantity is ``scale`` times the volts or counts, plus ``offset``. The sample clock of the analog inputs paces the loop at
    ``period`` (hardware-timed single point), counters are latched by it; without analog inputs this computer keeps the time.
    """

    period: ClassVar[float] = 1e-3
    _analog: Any = None
    _drives: Any = None
    _tasks: tuple[Any, ...] = ()
    _counters: tuple[Any, ...] = ()

    def identity(self) -> str:
        """Return the devices."""
        return f"driver {' '.join(self._devices())}"

    def facts(self) -> str:
        """Return the devices."""
        return ", ".join(self._devices())

    def _devices(self) -> list[str]:
        return sorted({one.terminal.lstrip("/").partition("/")[0] for one in self.channels})

    def open(self) -> None:
        """Reserve the terminals and start the clock."""
        analog, counters = self._kinds()
        if missing := [one.name for one in self.channels if not one.terminal]:
            raise UsageError(f"rig '{self.name}': {', '.join(missing)} needs a terminal, such as Dev1/ai0")
        nidaqmx = _vendor()
        from nidaqmx.constants import AcquisitionType, AngleUnits

        point, rate = AcquisitionType.HW_TIMED_SINGLE_POINT, 1.0 / self.period
        opened: list[Any] = []

        def task() -> Any:
            opened.append(nidaqmx.Task())
            self._tasks = tuple(opened)
            return opened[-1]

        clock = ""
        if analog:
            self._analog = task()
            for one in analog:
                self._analog.ai_channels.add_ai_voltage_chan(one.terminal)
            self._analog.timing.cfg_samp_clk_timing(rate, sample_mode=point)
            clock = f"/{analog[0].terminal.lstrip('/').partition('/')[0]}/ai/SampleClock"
        latched = []
        for one in counters:
            latched.append(task())
            latched[-1].ci_channels.add_ci_ang_encoder_chan(one.terminal, units=AngleUnits.TICKS)
            if clock:
                latched[-1].timing.cfg_samp_clk_timing(rate, source=clock, sample_mode=point)
        self._counters = tuple(latched)
        self._drives = task()
        for one in self.given:
            low, high = sorted(self._volts(one, end) for end in one.range)
            self._drives.ao_channels.add_ao_voltage_chan(one.terminal, min_val=max(low, -10.0), max_val=min(high, 10.0))
        self.paced = bool(analog)
        self.safe()
        # the slaves of the sample clock first: none may miss its first edge
        for one in (*self._counters, *([self._analog] if analog else [])):
            one.start()

    def _kinds(self) -> tuple[list[Channel], list[Channel]]:
        counters = [one for one in self.measured if one.terminal.rpartition("/")[2].startswith(COUNTER)]
        return [one for one in self.measured if one not in counters], counters

    def read(self) -> Sequence[float]:
        """Wait for the next edge of the sample clock; return all quantities."""
        analog, counters = self._kinds()
        found: dict[str, float] = {}
        if analog:
            volts = np.atleast_1d(np.asarray(self._analog.read(timeout=self.deadline_s), dtype=np.float64)).ravel()
            found |= {one.name: float(value) for one, value in zip(analog, volts, strict=True)}
            with contextlib.suppress(Exception):  # not every device counts single points
                self.sample = int(self._analog.in_stream.total_samp_per_chan_acquired)
        for one, task in zip(counters, self._counters, strict=True):
            found[one.name] = float(task.read(timeout=self.deadline_s))
        return [found[one.name] * one.scale + one.offset for one in self.measured]

    def write(self, values: Sequence[float]) -> None:
        """Write all outputs, which takes effect at once."""
        volts = [self._volts(one, value) for one, value in zip(self.given, values, strict=True)]
        self._drives.write(volts if len(volts) > 1 else volts[0], auto_start=True, timeout=self.deadline_s)

    @staticmethod
    def _volts(channel: Channel, value: float) -> float:
        return (value - channel.offset) / channel.scale

    def close(self) -> None:
        """Stop and clear all tasks."""
        for one in reversed(self._tasks):
            with contextlib.suppress(Exception):
                one.close()
        self._tasks = ()


def _vendor() -> Any:
    import nidaqmx
    from nidaqmx.errors import DaqNotFoundError
    from nidaqmx.system import System

    try:
        _ = System.local().driver_version
    except DaqNotFoundError:
        raise HjcampError(
            "the NI-DAQmx driver is not installed on this computer: install it (python -m nidaqmx installdriver)"
        ) from None
    return nidaqmx
