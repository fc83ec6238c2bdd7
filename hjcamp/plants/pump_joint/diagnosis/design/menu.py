"""The menu of a rig: the tests that may be proposed, as settings of a campaign's condition."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

PRELOADS = (0.30, 0.40, 0.50)
REST_PRELOADS = (0.30, 0.50, 0.62)
HARDWARE_COST = 1.25
DITHER = {"controller.dither.amplitude_v": 1.2}
OPEN_LOOP: dict[str, Any] = {"controller": "open_loop", "procedure.adjustment.enabled": False}


@dataclass(frozen=True)
class Choice:
    """One test of the menu: the name of its condition, what it is in words, its settings, and what it costs.

    ``cost`` is 1 for a test that needs nothing but the command, more where somebody has to mount something.
    """

    name: str
    text: str
    settings: dict[str, Any] = field(hash=False)
    cost: float = 1.0


def _sine(amplitude: float, frequency: float, duration: float) -> tuple[str, str, dict[str, Any]]:
    name = f"sine_{frequency:g}hz_{amplitude:g}deg".replace(".", "p")
    settings = {"amplitude_deg": amplitude, "frequency_hz": frequency, "duration": duration}
    return name, f"sine of {amplitude:g} deg at {frequency:g} Hz", {"trajectory": "sine", **_of(settings)}


def _triangle(amplitude: float, frequency: float, duration: float) -> tuple[str, str, dict[str, Any]]:
    speed = 4 * amplitude * frequency
    name = f"triangle_{speed:g}deg_per_s".replace(".", "p")
    settings = {"amplitude_deg": amplitude, "frequency_hz": frequency, "duration": duration}
    return name, f"triangle of {amplitude:g} deg at {speed:g} deg/s", {"trajectory": "triangle", **_of(settings)}


def _move(kind: str, amplitude: float, rise: float, duration: float) -> tuple[str, str, dict[str, Any]]:
    word = {"cycloid": "cycloid", "ramp": "step"}[kind]
    name = f"{word}_{amplitude:g}deg_and_hold".replace("-", "minus")
    settings = {"amplitude_deg": amplitude, "rise_time": rise, "duration": duration}
    text = f"{word} of {amplitude:g} deg in {rise:g} s, then {duration - rise:g} s of hold"
    return name, text, {"trajectory": kind, **_of(settings)}


def _rests() -> tuple[str, str, dict[str, Any]]:
    parts: list[dict[str, Any]] = []
    for change, rest in ((40.0, 0.1), (-40.0, 2.0), (40.0, 0.5), (-40.0, 0.1)):
        parts += [{"by_deg": change, "in": 0.3}, {"rest": rest}]
    settings = {"trajectory": "segments", **_of({"segments": parts})}
    return "moves_with_rests", "moves of 40 deg with rests of 0.1, 2 and 0.5 s", settings


def _hold(duration: float) -> tuple[str, str, dict[str, Any]]:
    return "hold", f"hold for {duration:g} s", {"trajectory": "hold", **_of({"angle_deg": 0.0, "duration": duration})}


def _of(parameters: dict[str, Any]) -> dict[str, Any]:
    return {f"trajectory.{name}": value for name, value in parameters.items()}


def _open_loop_shapes() -> list[tuple[str, str, dict[str, Any]]]:
    return [
        _sine(60.0, 0.5, 4.0),
        _sine(80.0, 1.0, 3.0),
        _sine(45.0, 2.0, 2.0),
        _sine(45.0, 4.0, 2.0),
        _sine(40.0, 6.0, 2.0),
        _sine(30.0, 9.0, 2.0),
        _triangle(20.0, 0.15, 6.7),
        _triangle(45.0, 0.25, 4.0),
        _triangle(60.0, 1.5, 2.0),
        _move("cycloid", 70.0, 0.6, 3.0),
        _move("cycloid", -70.0, 0.6, 3.0),
        _move("ramp", 60.0, 0.1, 2.0),
        _rests(),
    ]


def _at(
    shape: tuple[str, str, dict[str, Any]], preload: float, more: dict[str, Any], mark: str = "", words: str = ""
) -> Choice:
    name, text, settings = shape
    full = f"{name}{mark}_{preload:.2f}mpa".replace(".", "p")
    cost = HARDWARE_COST if {"payload", "orientation"} & set(more) else 1.0
    return Choice(full, text + words, {**settings, **more, "procedure.preload_mpa": preload}, cost)


def menu() -> list[Choice]:
    """Return every test of the menu: open and closed loop, slow to 9 Hz, several preloads, rests, payload, orientation."""
    return list(_menu())


def _menu() -> Iterator[Choice]:
    for shape in _open_loop_shapes():
        for preload in PRELOADS:
            yield _at(shape, preload, OPEN_LOOP)
    for preload in REST_PRELOADS:
        yield _at(_hold(10.0), preload, OPEN_LOOP)
    middle = PRELOADS[1]
    for shape in (_sine(80.0, 1.0, 3.0), _triangle(45.0, 0.25, 4.0)):
        yield _at(shape, middle, OPEN_LOOP | DITHER, "_dither", " with dither")
    for shape in (_sine(50.0, 1.0, 3.0), _sine(20.0, 3.0, 2.0), _move("cycloid", 100.0, 1.0, 2.0)):
        yield _at(shape, middle, {"controller": "pid"}, "_pid", " under PID")
    brass = {"payload": "brass_8p5g"}
    upright = {**brass, "orientation": "vertical"}
    for shape in (_sine(45.0, 2.0, 2.0), _sine(40.0, 6.0, 2.0)):
        yield _at(shape, middle, OPEN_LOOP | brass, "_brass", " with the brass payload")
    for shape in (_sine(80.0, 1.0, 3.0), _triangle(45.0, 0.25, 4.0)):
        yield _at(shape, middle, OPEN_LOOP | upright, "_upright", " with the brass payload, upright")
