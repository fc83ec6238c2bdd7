"""The tests of a campaign: reference signals, and menus of conditions."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

PRELOADS_MPA = (0.30, 0.35, 0.40, 0.45, 0.50)
ARM_LIMIT_DEG = 110.0


def _time(duration: float) -> np.ndarray:
    return np.arange(round(duration * 1000)) / 1000


def sine(frequency: float, duration: float) -> np.ndarray:
    """Return a sine of amplitude 1 at 1 kHz."""
    return np.sin(2 * np.pi * frequency * _time(duration))


def points(*corners: tuple[float, float]) -> np.ndarray:
    """Return straight lines through (time in s, level) corners at 1 kHz."""
    times, levels = zip(*corners, strict=True)
    return np.interp(_time(times[-1]), times, levels)


def cycloids(*moves: tuple[float, float, float]) -> np.ndarray:
    """Return cycloidal moves, each (change of level, duration in s, rest after it in s), at 1 kHz."""
    parts, level = [], 0.0
    for change, duration, rest in moves:
        share = _time(duration) / duration
        parts.append(level + change * (share - np.sin(2 * np.pi * share) / (2 * np.pi)))
        level += change
        parts.append(np.full(round(rest * 1000), level))
    return np.concatenate(parts)


@dataclass(frozen=True)
class Condition:
    """One condition: a reference of unit amplitude, its amplitude in degrees of the arm, controller and preload."""

    name: str
    trajectory: str
    shape: Callable[[], np.ndarray]
    amplitude_deg: float
    preload_mpa: float
    closed_loop: bool = False
    dither_volt: float = 0.0
    adjustment_mpa: float = 0.0

    def reference(self) -> np.ndarray:
        """Return the reference in degrees at 1 kHz."""
        return self.amplitude_deg * self.shape()


def _mixed() -> np.ndarray:
    return cycloids((1, 1, 1), (-1, 1, 0.5), (0.5, 0.5, 0.5), (-0.5, 0.5, 1))


STANDARD = (
    Condition("sine_0p5hz_mid", "sine_0p5hz", lambda: sine(0.5, 4), 60, 0.40),
    Condition("sine_1hz_large", "sine_1hz", lambda: sine(1, 3), 80, 0.45, False, 1.2),
    Condition("sine_2hz_small", "sine_2hz_open_loop", lambda: sine(2, 2), 45, 0.50),
    Condition("triangle_slow", "triangle", lambda: points((0, 0), (1.5, 1), (4.5, -1), (6, 0)), 45, 0.35, False, 1.2),
    Condition("ramp_hold", "cycloid_hold", lambda: cycloids((1, 0.6, 1.9), (-1.57, 0.7, 1.8)), 70, 0.30),
    Condition("sine_1hz_pid", "sine_1hz", lambda: sine(1, 3), 50, 0.40, True, 1.2, 0.2),
    Condition("cycloid_pid", "cycloid_pos", lambda: cycloids((1, 1, 1)), 100, 0.45, True, 0.0, 0.2),
    Condition("mixed_pid", "mixed", _mixed, 100, 0.50, True, 1.2, 0.2),
)
OPEN_LOOP = STANDARD[:5]
SHORT = (STANDARD[0], STANDARD[4], STANDARD[6])
FEW = (Condition("ramp_pos_only", "ramp", lambda: points((0, 0), (1.0, 1)), 60, 0.40),)
MENUS = {"standard": STANDARD, "open_loop": OPEN_LOOP, "short": SHORT, "few": FEW}


def vary(menu: tuple[Condition, ...], seed: int) -> tuple[Condition, ...]:
    """Return the menu as another bench would run it: other amplitudes and preloads, the arm within its range."""
    random = np.random.default_rng([seed, 103])
    varied = []
    for condition in menu:
        amplitude = round(condition.amplitude_deg * random.uniform(0.85, 1.1))
        preload = condition.preload_mpa + float(random.choice([-0.05, 0.0, 0.05]))
        preload = min(max(preload, PRELOADS_MPA[0]), PRELOADS_MPA[-1])
        changes = {"amplitude_deg": min(amplitude, ARM_LIMIT_DEG), "preload_mpa": round(preload, 3)}
        varied.append(replace(condition, **changes))  # type: ignore[arg-type]
    return tuple(varied)


def asked(name: str, settings: Mapping[str, Any]) -> Condition:
    """Return the condition that the settings of a campaign ask for, as a bench would set it up; no payload."""
    shape = {key.partition(".")[2]: value for key, value in settings.items() if key.startswith("trajectory.")}
    kind = settings["trajectory"]
    if settings.get("payload", "none") != "none" or settings.get("orientation", "horizontal") != "horizontal":
        raise ValueError(f"{name}: this bench cannot change its payload within a campaign")
    closed = settings["controller"] == "pid"
    return Condition(
        name,
        kind,
        lambda: _asked_shape(kind, shape),
        float(shape.get("amplitude_deg", 1.0)),
        float(settings["procedure.preload_mpa"]),
        closed,
        float(settings.get("controller.dither.amplitude_v", 1.2 if closed else 0.0)),
        0.2 if closed else 0.0,
    )


def _asked_shape(kind: str, shape: Mapping[str, Any]) -> np.ndarray:
    if kind == "sine":
        return sine(shape["frequency_hz"], shape["duration"])
    if kind == "triangle":
        phase = shape["frequency_hz"] * _time(shape["duration"]) + 0.25
        return 1 - 4 * np.abs(phase % 1 - 0.5)
    if kind == "cycloid":
        return cycloids((1, shape["rise_time"], shape["duration"] - shape["rise_time"]))
    if kind == "ramp":
        return points((0, 0), (shape["rise_time"], 1), (shape["duration"], 1))
    if kind == "hold":
        return np.full(round(shape["duration"] * 1000), shape["angle_deg"])
    if kind == "segments":
        parts = shape["segments"]
        return cycloids(*[(parts[k]["by_deg"], parts[k]["in"], parts[k + 1]["rest"]) for k in range(0, len(parts), 2)])
    raise ValueError(f"this bench knows no {kind}")
