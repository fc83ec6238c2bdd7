"""The tasks of the vendor's API that one test needs: read all sensors at one clock edge, write all outputs, be safe."""

from __future__ import annotations

import contextlib
import time
import warnings
from typing import Any

import numpy as np
from nidaqmx import DaqWarning, Task
from nidaqmx.constants import (
    AcquisitionType,
    AngleUnits,
    EncoderType,
    TerminalConfiguration,
    WatchdogAOExpirState,
)
from nidaqmx.errors import Error
from nidaqmx.stream_readers import AnalogMultiChannelReader, CounterReader
from nidaqmx.stream_writers import AnalogMultiChannelWriter
from nidaqmx.system import Device
from nidaqmx.system.watchdog import WatchdogTask
from nidaqmx.types import AOExpirationState

from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.plants.pump_joint.rig.connection import Connection
from hjcamp.plants.pump_joint.rig.left import LeftAt
from hjcamp.plants.pump_joint.rig.wiring import Wiring

RATE = 1000.0
DECODING = {"x1": EncoderType.X_1, "x2": EncoderType.X_2, "x4": EncoderType.X_4}
TERMINALS = {
    "diff": TerminalConfiguration.DIFF,
    "rse": TerminalConfiguration.RSE,
    "nrse": TerminalConfiguration.NRSE,
    "default": TerminalConfiguration.DEFAULT,
}
WATCHDOG_EXPIRED = -200678
IN_USE = (-50103, -201420, -200089)
AT_START = LeftAt(0.0, 0.0)


class RigTasks:
    """The running tasks of one test.

    ``read`` waits for the next edge of the sample clock (hardware-timed single point): it is what paces the loop.
    ``left`` is where pump motor and arm stand before the first sample, as their counters count it.
    ``volts`` (2,) and ``counts`` (arm, pump) hold what was read; ``acquired`` is the device's own count of samples.
    ``put_out`` is the command (rad) and the dither (V) that the outputs really gave after the last ``write``, ``beyond``
    the first output that was asked for more than its range, with the volts asked; None where all could be given.
    """

    def __init__(self, wiring: Wiring, connection: Connection, timeout: float, left: LeftAt = AT_START) -> None:
        self.wiring = wiring
        self.volts = np.zeros(2)
        self.counts = [0.0, 0.0]
        self.acquired = 0
        self.put_out = (left.motor, 0.0)
        self.beyond: tuple[str, float] | None = None
        self.is_safe = True
        self.watchdog_was_first = False
        self._timeout = timeout
        self._left = left
        self._last_ns = 0
        self._options = connection.options
        self._watchdog: Any = None
        self._guarded = False
        self._opened: list[Any] = []
        self._asked = np.zeros(len(wiring.outputs))
        self._written = np.zeros(len(wiring.outputs))
        self._names = list(wiring.outputs)
        self._counts_samples = True
        try:
            self._open()
        except Error as error:
            self.close()
            reason = "another program uses it" if getattr(error, "error_code", 0) in IN_USE else "it cannot be opened"
            raise RigUnavailable(f"rig: {reason}: {first_line(error)}") from error
        except BaseException:
            self.close()
            raise

    def _open(self) -> None:
        wiring = self.wiring
        analog = self._task()
        for sensor in wiring.pressures.values():
            terminal = TERMINALS.get(sensor.terminal, TerminalConfiguration.DEFAULT)
            analog.ai_channels.add_ai_voltage_chan(sensor.channel, "", terminal, -10.0, 10.0)
        point = AcquisitionType.HW_TIMED_SINGLE_POINT
        analog.timing.cfg_samp_clk_timing(RATE, sample_mode=point)
        clock = f"/{wiring.pressures['pressure1'].channel.lstrip('/').split('/')[0]}/ai/SampleClock"
        self._counters = []
        for name, encoder in wiring.encoders.items():
            angle = self._left.motor if name == "pump" else self._left.arm
            start = round(encoder.sign * angle / encoder.count)
            task = self._task()
            task.ci_channels.add_ci_ang_encoder_chan(
                encoder.channel,
                decoding_type=DECODING[encoder.decoding],
                units=AngleUnits.TICKS,
                pulses_per_rev=encoder.pulses_per_turn,
                initial_angle=float(start),
            )
            task.timing.cfg_samp_clk_timing(RATE, source=clock, sample_mode=point)
            self._counters.append(CounterReader(task.in_stream))
        drives = self._task()
        for output in wiring.outputs.values():
            drives.ao_channels.add_ao_voltage_chan(output.channel, "", output.lowest_v, output.highest_v)
        if wiring.timing == "hardware_timed":
            drives.timing.cfg_samp_clk_timing(RATE, source=clock, sample_mode=point)
        self._writer = AnalogMultiChannelWriter(drives.out_stream, auto_start=wiring.timing == "on_demand")
        self._writer.verify_array_shape = False
        self._reader = AnalogMultiChannelReader(analog.in_stream)
        self._reader.verify_array_shape = False
        self._in_stream = analog.in_stream
        self._opened_watchdog()
        self._write_safe(self._left.motor)
        # The slaves of the sample clock first: none may miss its first edge.
        for task in [*self._opened[1:3], *([drives] if wiring.timing == "hardware_timed" else []), analog]:
            task.start()

    def _task(self) -> Any:
        task = Task(grpc_options=self._options)
        self._opened.append(task)
        return task

    def _opened_watchdog(self) -> None:
        if self.wiring.watchdog_s is None:
            return
        states = [
            AOExpirationState(output.channel, output.safe_v or 0.0, WatchdogAOExpirState.VOLTAGE)
            if output.safe_v is not None
            else AOExpirationState(output.channel, 0.0, WatchdogAOExpirState.NO_CHANGE)
            for output in self.wiring.outputs.values()
        ]
        device = self.wiring.outputs["pump"].channel.lstrip("/").split("/")[0]
        self._watchdog = WatchdogTask(device, timeout=self.wiring.watchdog_s, grpc_options=self._options)
        self._watchdog.cfg_watchdog_ao_expir_states(states)

    def read(self) -> int:
        """Wait for the next sample; return how many samples were missed since the last one."""
        self._reader.read_one_sample(self.volts, self._timeout)
        before = self.acquired
        if self._counts_samples:
            try:
                self.acquired = int(self._in_stream.total_samp_per_chan_acquired)
            except Error:
                if before:
                    raise
                # Not every device counts single points; then the wall clock tells.
                self._counts_samples = False
        if not self._counts_samples:
            now = time.perf_counter_ns()
            passed = round((now - self._last_ns) * 1e-9 * RATE) if self._last_ns else 1
            self.acquired, self._last_ns = before + max(1, passed), now
        self.counts[0] = self._counters[0].read_one_sample_double(self._timeout)
        self.counts[1] = self._counters[1].read_one_sample_double(self._timeout)
        return max(0, self.acquired - before - 1) if before else 0

    def write(self, command: float, motor: float, dither: float, preload_speed: float) -> None:
        """Write all outputs: pump command and measured motor angle (rad), dither (V), preload speed (m/s)."""
        wiring, out = self.wiring, self._asked
        in_voltage = wiring.quantity == "voltage"
        self.put_out, self.beyond = (command, dither), None
        for place, name in enumerate(self._names):
            output = wiring.outputs[name]
            if name == "preload":
                value = preload_speed
            elif name == "dither":
                value = dither
            else:
                value = (command - motor) * wiring.loop_v_per_rad + dither if in_voltage else command
            asked = value * output.volts_per_unit
            out[place] = given = output.within(asked)
            if given != asked:
                self.beyond = self.beyond or (name, asked)
                self._clipped(name, given / output.volts_per_unit, motor)
        self.is_safe = False
        self._writer.write_one_sample(out, self._timeout)
        self._written[:] = out
        if self._watchdog is not None:
            # Until the first write the outputs are safe, and what comes before it may take longer than the timeout.
            if self._guarded:
                self._watchdog.reset_timer()
            else:
                self._watchdog.start()
                self._guarded = True

    def _clipped(self, name: str, value: float, motor: float) -> None:
        """Correct ``put_out`` by what an output gave: ``value`` in the unit of its scale."""
        command, dither = self.put_out
        if name == "dither":
            dither = value
        elif name == "pump" and self.wiring.quantity == "voltage":
            command = motor + (value - dither) / self.wiring.loop_v_per_rad
        elif name == "pump":
            command = value
        self.put_out = (command, dither)

    def make_safe(self, motor: float) -> str | None:
        """Write the safe state of all outputs; return what prevented it, None where it was done."""
        for _ in range(2):
            try:
                self._write_safe(motor)
            except (Error, OSError, ValueError) as error:
                if getattr(error, "error_code", None) == WATCHDOG_EXPIRED:
                    # The device was faster: its outputs have their safe state already.
                    self.is_safe = self.watchdog_was_first = True
                    return None
                problem = first_line(error)
            else:
                self.is_safe = True
                return None
        return f"{problem}; last written: {self.last_written()}"

    def stands_at(self, motor: float) -> float:
        """Return where a pump that holds its position stands (rad): where it was measured, or at its last command."""
        if not self.watchdog_was_first:
            return motor
        return float(self._written[self._names.index("pump")] / self.wiring.outputs["pump"].volts_per_unit)

    def last_written(self) -> str:
        """Return every output with the voltage that was last written to it."""
        outputs = self.wiring.outputs
        written = zip(self._names, self._written, strict=True)
        return ", ".join(f"{name} {outputs[name].channel} {volts:.4g} V" for name, volts in written)

    def _write_safe(self, motor: float) -> None:
        outputs = self.wiring.outputs
        safe = [outputs[name].volts(motor) if (volts := outputs[name].safe_v) is None else volts for name in self._names]
        self._writer.write_one_sample(np.array(safe), self._timeout)
        self._written[:] = safe

    def close(self) -> None:
        """Stop and clear all tasks; never raises for a device that is gone."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DaqWarning)
            for task in [self._watchdog, *reversed(self._opened)]:
                if task is not None:
                    with contextlib.suppress(Error, OSError):
                        task.stop()
                    try:
                        task.close()
                    except (Error, OSError):
                        # Otherwise its destructor warns; the server drops what it holds with the session.
                        task._close_on_exit = False
                        task._handle = None
        self._opened, self._watchdog = [], None


def last_words(tasks: RigTasks) -> str:
    """Return what is known of the outputs while a call is stuck."""
    return "The outputs are safe" if tasks.is_safe else not_written(tasks, f"last written: {tasks.last_written()}")


def not_written(tasks: RigTasks, problem: str) -> str:
    """Return what to say where the outputs could not be made safe, and what does it without us."""
    timeout = tasks.wiring.watchdog_s
    watchdog = (
        "The device has no watchdog" + (f"; rig.interlock: {tasks.wiring.interlock}" if tasks.wiring.interlock else "")
        if timeout is None
        else f"The device's watchdog makes them safe {timeout * 1e3:g} ms after the last write"
    )
    return f"THE OUTPUTS COULD NOT BE WRITTEN ({problem}): switch the drives off by hand. {watchdog}"


def device_facts(wiring: Wiring, connection: Connection) -> str:
    """Return product and serial number of each device, for the log; nothing is reserved or moved."""
    facts = []
    for name in wiring.devices:
        with contextlib.suppress(Error, OSError):
            device = Device(name, grpc_options=connection.options)
            facts.append(f"{name} {device.product_type} {device.serial_num:08X}")
    return ", ".join(facts)


def first_line(error: BaseException) -> str:
    """Return what an error of the vendor's client says, in one line with its code."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    code = getattr(error, "error_code", None)
    text = lines[0].removeprefix(f"{getattr(error, 'rpc_code', '')}: ") if lines else type(error).__name__
    return text + (f" (error {code})" if code else "")
