"""What is wired to which terminal, and how volts and counts become SI units; read from the rig's configuration."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hjcamp.errors import UsageError, unknown

DEGREE = math.pi / 180
DECODING = {"x1": 1, "x2": 2, "x4": 4}
CONNECTIONS = ("in_process", "address", "driver")
QUANTITIES = ("position", "voltage")
TERMINALS = ("diff", "rse", "nrse", "default")
TIMINGS = ("on_demand", "hardware_timed")


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
    rig = config["rig"]
    where = f"rig '{rig.get('name')}'"
    for key in ("connection", "inputs", "outputs", "limits"):
        if not isinstance(rig.get(key), Mapping):
            raise UsageError(
                f"{where}: '{key}' is missing; a rig for backend=nidaqmx describes its wiring (docs/rig.md)"
            )
    _one_of(rig["connection"].get("kind"), CONNECTIONS, "connection.kind", where)
    given = rig["outputs"]
    quantity = _one_of(_part(given, "pump", where).get("quantity"), QUANTITIES, "outputs.pump.quantity", where)
    timing = _one_of(rig.get("output_timing", "on_demand"), TIMINGS, "output_timing", where)
    outputs = {
        "pump": _output(given["pump"], "v_per_deg", 1 / DEGREE, where)
        if quantity == "position"
        else _output({**given["pump"], "sign": given["pump"].get("sign", 1)}, "sign", 1.0, where),
        "preload": _output(_part(given, "preload", where), "v_per_mm_per_s", 1e3, where),
    }
    if given.get("dither") and quantity == "position":
        outputs["dither"] = _output(given["dither"], "v_per_v", 1.0, where)
    if outputs["preload"].safe_v is None or (quantity == "voltage" and outputs["pump"].safe_v is None):
        raise UsageError(f"{where}: only a pump drive that takes a position can hold; give safe_v a voltage")
    watchdog = rig.get("watchdog") or {}
    wiring = Wiring(
        {name: _pressure(_part(rig["inputs"], name, where), where) for name in ("pressure1", "pressure2")},
        {name: _encoder(_part(rig["inputs"], name, where), where) for name in ("arm", "pump")},
        outputs,
        quantity,
        _number(given["pump"], "loop_v_per_deg", where, 1 / 36) / DEGREE,
        float(config["amplifier"].get("command_deg_per_v", 36.0)) * DEGREE,
        timing,
        _number(watchdog, "timeout_ms", where) * 1e-3 if watchdog.get("enabled") else None,
        (),
        rig.get("interlock"),
    )
    return _with_devices(wiring, config, where)


def _with_devices(wiring: Wiring, config: Mapping[str, Any], where: str) -> Wiring:
    terminals = [one.channel for one in wiring.pressures.values()]
    terminals += [one.channel for one in wiring.encoders.values()]
    terminals += [one.channel for one in wiring.outputs.values()]
    twice = {one for one in terminals if terminals.count(one) > 1}
    if twice:
        raise UsageError(f"{where}: {', '.join(sorted(twice))} is used twice; each terminal carries one signal")
    for name, key in (("arm", "encoder_counts_per_turn"), ("pump", "pump_counts_per_turn")):
        encoder, stated = wiring.encoders[name], config["rig"]["sensors"][key]
        counts = encoder.pulses_per_turn * DECODING[encoder.decoding]
        if counts != stated:
            raise UsageError(f"{where}: inputs.{name} gives {counts} counts a turn, sensors.{key} says {stated:g}")
    devices = tuple(dict.fromkeys(one.lstrip("/").split("/")[0] for one in terminals))
    return Wiring(**{**wiring.__dict__, "devices": devices})


def _part(given: Mapping[str, Any], name: str, where: str) -> Mapping[str, Any]:
    part = given.get(name)
    if not isinstance(part, Mapping) or not part.get("channel"):
        raise UsageError(f"{where}: '{name}' has no channel; name its terminal, such as Dev1/ai0")
    return part


def _pressure(given: Mapping[str, Any], where: str) -> PressureInput:
    slope = _number(given, "mpa_per_v", where)
    if slope == 0.0:
        raise UsageError(f"{where}: mpa_per_v is 0; a sensor has a slope")
    offset, lowest, highest = (_number(given, key, where) for key in ("mpa_at_0v", "lowest_v", "highest_v"))
    terminal = _one_of(given.get("terminal", "diff"), TERMINALS, "terminal", where)
    return PressureInput(str(given["channel"]), slope, offset, lowest, highest, terminal)


def _encoder(given: Mapping[str, Any], where: str) -> EncoderInput:
    decoding = _one_of(given.get("decoding", "x4"), tuple(DECODING), "decoding", where)
    pulses, sign = _number(given, "pulses_per_turn", where), _number(given, "sign", where, 1)
    if pulses < 1 or pulses != int(pulses) or sign not in (-1, 1):
        raise UsageError(f"{where}: {given['channel']}: pulses_per_turn is a whole number, sign is 1 or -1")
    return EncoderInput(str(given["channel"]), int(pulses), decoding, int(sign))


def _output(given: Mapping[str, Any], scale: str, factor: float, where: str) -> Output:
    slope = _number(given, scale, where) * factor
    lowest, highest = _number(given, "lowest_v", where), _number(given, "highest_v", where)
    safe = None if given.get("safe_v") == "hold" else _number(given, "safe_v", where)
    if slope == 0.0 or lowest >= highest or (safe is not None and not lowest <= safe <= highest):
        raise UsageError(f"{where}: {given['channel']}: {scale} must not be 0, and lowest_v <= safe_v <= highest_v")
    return Output(str(given["channel"]), slope, lowest, highest, safe)


def _number(given: Mapping[str, Any], key: str, where: str, default: float | None = None) -> float:
    value = given.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise UsageError(f"{where}: {key} is {value!r}; a number is needed")
    return float(value)


def _one_of(value: Any, allowed: Sequence[str], key: str, where: str) -> str:
    if value not in allowed:
        raise unknown(key, str(value), allowed, where)
    return str(value)
