"""Check the values of one condition's configuration before anything is run or written."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from hjcamp.errors import UsageError, unknown

POSITIVE = (
    "pump.bore_mm",
    "pump.lead_mm_per_rev",
    "pump.speed_limit_mm_per_s",
    "tubing.stiffness_mpa_per_mm3",
    "joint.bore_mm",
    "joint.pulley_pitch_diameter_mm",
    "joint.moving_mass_g",
    "payload.radius_mm",
    "procedure.preload_speed_mm_per_s",
    "procedure.adjustment.speed_mm_per_s",
    "procedure.phase_limit_s",
    "rig.sensors.encoder_counts_per_turn",
    "rig.sensors.pump_counts_per_turn",
    "rig.scatter.friction_correlation_s",
    "amplifier.command_deg_per_v",
)
NOT_NEGATIVE = (
    "payload.mass_g",
    "procedure.rest_ms",
    "rig.sensors.pressure_noise_mpa",
    "rig.scatter.friction_between",
    "rig.scatter.friction_within",
    "rig.scatter.initial_pressure_mpa",
    *(
        f"friction.{side}.{name}"
        for side in ("positive", "negative")
        for name in ("static_n", "coulomb_n", "viscous_ns_per_mm")
    ),
)
POSITIVE_OR_ABSENT = ("pump.acceleration_limit_mm_per_s2", "joint.travel_stop_deg")
NUMBERS_IF_THERE = (
    "controller.scale",
    *(f"controller.{side}.{gain}" for side in ("positive", "negative") for gain in ("kp", "ki", "kd")),
    "controller.dither.amplitude_v",
    "controller.dither.frequency_hz",
    "controller.feedforward.gain",
)
GROUPS = (
    "pump", "amplifier", "tubing", "joint", "friction", "payload", "orientation",
    "controller", "trajectory", "procedure", "backend", "rig", "model",
)  # fmt: skip
REQUIRED_SAMPLING_HZ = 1000


def check_values(config: Mapping[str, Any], where: str) -> None:
    """Raise ``UsageError`` for a value that no test can be made with; ``where`` names the condition."""
    for group in GROUPS:
        if not isinstance(config.get(group), Mapping):
            raise UsageError(f"{where}: the group '{group}' is missing; every condition needs a choice of it")
    for path, value in leaves(config):
        if isinstance(value, float) and not math.isfinite(value):
            raise UsageError(f"{where}: {path} is {value}; a finite number is needed")
    for path in POSITIVE:
        _number(config, path, where, lowest=0.0, excluded=True)
    for path in NOT_NEGATIVE:
        _number(config, path, where, lowest=0.0)
    for path in POSITIVE_OR_ABSENT:
        if look_up(config, path) is not None:
            _number(config, path, where, lowest=0.0, excluded=True)
    for path in NUMBERS_IF_THERE:
        if _is_there(config, path):
            _number(config, path, where)
    _amplifier_fits(config, where)
    samples = look_up(config, "controller.derivative_samples")
    if samples is not None and (not is_whole(samples) or samples < 1):
        raise UsageError(
            f"{where}: controller.derivative_samples is {samples!r}; a whole number of at least 1 is needed"
        )
    if look_up(config, "procedure.sampling_hz") != REQUIRED_SAMPLING_HZ:
        raise UsageError(f"{where}: procedure.sampling_hz must be {REQUIRED_SAMPLING_HZ}, the rate of a test log")


def check_count(value: Any, name: str, lowest: int = 1) -> int:
    """Return ``value`` as a whole number of at least ``lowest``; raises ``UsageError``."""
    if not is_whole(value) or value < lowest:
        raise UsageError(f"{name} is {value!r}; a whole number of at least {lowest} is needed")
    return int(value)


def is_whole(value: Any) -> bool:
    """Return whether ``value`` is an integer (a bool is none)."""
    return isinstance(value, int) and not isinstance(value, bool)


def look_up(config: Mapping[str, Any], path: str) -> Any:
    """Return the value at a dotted path, None where there is none."""
    place: Any = config
    for part in path.split("."):
        if not isinstance(place, Mapping) or part not in place:
            return None
        place = place[part]
    return place


def leaves(config: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each value of a nested configuration with its dotted path."""
    if isinstance(config, Mapping):
        for key, value in config.items():
            yield from leaves(value, f"{path}.{key}" if path else str(key))
    elif isinstance(config, list | tuple):
        for position, value in enumerate(config):
            yield from leaves(value, f"{path}[{position}]")
    else:
        yield path, config


def _is_there(config: Mapping[str, Any], path: str) -> bool:
    parent, _, name = path.rpartition(".")
    holder = look_up(config, parent)
    return isinstance(holder, Mapping) and name in holder


def _number(
    config: Mapping[str, Any], path: str, where: str, lowest: float | None = None, excluded: bool = False
) -> None:
    value = look_up(config, path)
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise UsageError(f"{where}: {path} is {value!r}; a number is needed")
    if lowest is not None and (value < lowest or (excluded and value == lowest)):
        need = "a number above zero" if excluded else "zero or more"
        raise UsageError(f"{where}: {path} is {value}; {need} is needed")


def _amplifier_fits(config: Mapping[str, Any], where: str) -> None:
    functions = look_up(config, "pump.transfer_function")
    if not isinstance(functions, Mapping) or not functions:
        raise UsageError(f"{where}: pump.transfer_function is missing; one for each amplifier is needed")
    amplifier = str(look_up(config, "amplifier.name"))
    if amplifier not in functions:
        error = unknown("amplifier", amplifier, functions, f"pump '{look_up(config, 'pump.name')}'")
        raise UsageError(f"{where}: {error}")
    for name in functions[amplifier]:
        path = f"pump.transfer_function.{amplifier}.{name}"
        _number(config, path, where, lowest=0.0, excluded=name != "delay_ms")
