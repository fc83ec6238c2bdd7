"""What is wired to which terminal, and how volts and counts become SI units; read from the rig's configuration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.plants.pump_joint.rig.schema import EncoderSettings, OutputSettings, PressureSettings, PumpOutput, WiredRig
from hjcamp.schema import checked

DEGREE = math.pi / 180
DECODING = {"x1": 1, "x2": 2, "x4": 4}


@dataclass(frozen=True)
class PressureInput:
    """A pressure sensor on an analog input: p [MPa] = ``mpa_per_v`` V + ``mpa_at_0v``; outside the volts it is lost."""

    channel: str
    mpa_per_v: float
    mpa_at_0v: float
    lowest_v: float
    highest_v: float
    terminal: str

    def pascal(self, volts: float) -> float:
        """Return the gauge pressure in Pa."""
        return (volts * self.mpa_per_v + self.mpa_at_0v) * 1e6

    def volts(self, pascal: float) -> float:
        """Return the sensor's voltage at a gauge pressure in Pa."""
        return (pascal * 1e-6 - self.mpa_at_0v) / self.mpa_per_v


@dataclass(frozen=True)
class EncoderInput:
    """An incremental encoder on a counter; ``sign`` is -1 where it counts against the positive direction."""

    channel: str
    pulses_per_turn: int
    decoding: str
    sign: int

    @property
    def count(self) -> float:
        """One count, rad."""
        return 2 * math.pi / (self.pulses_per_turn * DECODING[self.decoding])


@dataclass(frozen=True)
class Output:
    """An analog output: volts for one SI unit, the range, and the safe voltage (None: hold the measured position)."""

    channel: str
    volts_per_unit: float
    lowest_v: float
    highest_v: float
    safe_v: float | None

    def volts(self, value: float) -> float:
        """Return the voltage for an SI value, held within the range."""
        return self.within(value * self.volts_per_unit)

    def within(self, volts: float) -> float:
        """Return the voltage that the output gives where this one is asked of it."""
        return min(max(volts, self.lowest_v), self.highest_v)


@dataclass(frozen=True)
class Wiring:
    """All terminals of a rig. ``quantity``: the pump drive takes a position, or a motor voltage (we close the loop);
    ``interlock``: what stops the drives where the device has no watchdog."""

    pressures: dict[str, PressureInput]
    encoders: dict[str, EncoderInput]
    outputs: dict[str, Output]
    quantity: str
    loop_v_per_rad: float
    command_rad_per_v: float
    timing: str
    watchdog_s: float | None
    devices: tuple[str, ...]
    interlock: str | None = None

    def physical_outputs(self, volts: Mapping[str, float]) -> tuple[float, float, float]:
        """Return what the voltages mean to the drives: pump command (rad), dither (V), preload speed (m/s)."""
        pump, preload = self.outputs["pump"], self.outputs["preload"]
        speed = volts[preload.channel] / preload.volts_per_unit
        if self.quantity == "voltage":
            return volts[pump.channel] * pump.volts_per_unit * self.command_rad_per_v, 0.0, speed
        dither = self.outputs.get("dither")
        shake = volts[dither.channel] / dither.volts_per_unit if dither else 0.0
        return volts[pump.channel] / pump.volts_per_unit, shake, speed


def read_wiring(config: Mapping[str, Any]) -> Wiring:
    """Return the wiring of ``config["rig"]``; raises ``UsageError`` for what is missing or impossible."""
    rig = checked(WiredRig, config["rig"], "rig")
    outputs = {"pump": _pump(rig.outputs.pump), "preload": _output(rig.outputs.preload, 1e3)}
    if rig.outputs.dither is not None and rig.outputs.pump.quantity == "position":
        outputs["dither"] = _output(rig.outputs.dither, 1.0)
    inputs, watchdog = rig.inputs, rig.watchdog
    wiring = Wiring(
        {name: _pressure(getattr(inputs, name)) for name in ("pressure1", "pressure2")},
        {name: _encoder(getattr(inputs, name)) for name in ("arm", "pump")},
        outputs,
        rig.outputs.pump.quantity,
        rig.outputs.pump.loop_v_per_deg / DEGREE,
        float(config["amplifier"].get("command_deg_per_v", 36.0)) * DEGREE,
        rig.output_timing,
        watchdog.timeout_ms * 1e-3 if watchdog is not None and watchdog.enabled else None,
        (),
        rig.interlock,
    )
    return _with_devices(wiring, rig)


def _with_devices(wiring: Wiring, rig: WiredRig) -> Wiring:
    terminals = [one.channel for one in wiring.pressures.values()]
    terminals += [one.channel for one in wiring.encoders.values()]
    terminals += [one.channel for one in wiring.outputs.values()]
    twice = {one for one in terminals if terminals.count(one) > 1}
    if twice:
        raise UsageError(f"rig: {', '.join(sorted(twice))} is used twice; each terminal carries one signal")
    for name, key in (("arm", "encoder_counts_per_turn"), ("pump", "pump_counts_per_turn")):
        encoder, stated = wiring.encoders[name], getattr(rig.sensors, key)
        counts = encoder.pulses_per_turn * DECODING[encoder.decoding]
        if counts != stated:
            raise UsageError(f"rig.inputs.{name} gives {counts} counts a turn, rig.sensors.{key} says {stated}")
    devices = tuple(dict.fromkeys(one.lstrip("/").split("/")[0] for one in terminals))
    return Wiring(**{**wiring.__dict__, "devices": devices})


def _pressure(given: PressureSettings) -> PressureInput:
    return PressureInput(given.channel, given.mpa_per_v, given.mpa_at_0v, given.lowest_v, given.highest_v, given.terminal)


def _encoder(given: EncoderSettings) -> EncoderInput:
    return EncoderInput(given.channel, given.pulses_per_turn, given.decoding, given.sign)


def _pump(given: PumpOutput) -> Output:
    return _output(given, 1 / DEGREE if given.quantity == "position" else 1.0)


def _output(given: OutputSettings, factor: float) -> Output:
    slope = getattr(given, given.scale()) * factor
    safe = None if given.safe_v == "hold" else float(given.safe_v)
    return Output(given.channel, slope, given.lowest_v, given.highest_v, safe)
