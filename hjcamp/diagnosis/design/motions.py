"""Motions of a known form within what measured tests visited."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.design.wanted import Wanted
from hjcamp.diagnosis.residuals.initial_states import slope

Array = NDArray[np.float64]
# Readings that follow the first one to this share of their variance are moved with it.
GEARED = 0.9
SPEEDS = {"slow": 0.08, "at middle speed": 0.4, "fast": 0.95}
HALF = 8


def motions(measured: Measured, place: int, samples: int) -> Iterator[Wanted]:
    """Yield motions of a known form within what was visited: equal speeds both ways, with rests, about each end, quick."""
    places = np.concatenate([one.readings for one in measured.tests])
    lead = int(np.argmax(np.std(places / np.maximum(measured.noise, 1e-300), axis=0)))
    gears = [np.polyfit(places[:, lead], places[:, k], 1) for k in range(places.shape[1])]
    left = [np.std(places[:, k] - np.polyval(one, places[:, lead])) for k, one in enumerate(gears)]
    if any(rest**2 > (1.0 - GEARED) * np.var(places[:, k]) for k, rest in enumerate(left)):
        return
    low, high = np.percentile(places[:, lead], (2.0, 98.0))
    speed, rate = _usual_rates(measured, lead)
    if speed <= 0.0 or rate <= 0.0:
        return
    test, h = measured.tests[place], measured.period
    inputs = np.tile(np.median(test.inputs, axis=0), (samples, 1))

    def moved(name: str, text: str, path: Array, size: float) -> Wanted:
        # a corner takes as long as the usual acceleration needs to turn the speed round
        corner = int(np.clip(2.0 * size / (rate * h), 1, max(samples // 8, 1)))
        padded = np.pad(path, corner // 2, mode="edge")
        smooth = np.convolve(padded, np.ones(corner) / corner, mode="valid")[:samples]
        readings: Array = np.column_stack([one[0] * np.resize(smooth, samples) + one[1] for one in gears])
        return Wanted(name, text, place, inputs, readings, test.given, {"speed": size})

    time: Array = np.arange(samples, dtype=np.float64) * h
    unit = measured.sensors[lead]

    def shown(value: float) -> str:
        return f"{value * unit.scale:.3g} {unit.unit}"

    for word, share in SPEEDS.items():
        pace = share * speed
        if h * samples * pace < 5.0 * measured.noise[lead]:
            continue
        path = _triangle(low, high, pace, time)
        yield moved(f"equal_speeds_{word.split()[-1]}", f"to and fro at {shown(pace)}/s in both directions", path, pace)
    for name, bottom, top in (
        ("low_end", low, low + (high - low) / 3.0),
        ("high_end", high - (high - low) / 3.0, high),
    ):
        path = _triangle(bottom, top, 0.5 * speed, time)
        yield moved(name, f"to and fro between {shown(bottom)} and {shown(top)} at {shown(0.5 * speed)}/s", path, 0.5 * speed)
    size = min(0.1 * (high - low), speed**2 / rate)
    path = 0.5 * (low + high) + size * np.sin(np.sqrt(rate / size) * 0.7 * time)
    yield moved(
        "small_and_quick",
        f"a sine of {shown(size)} at {0.7 * np.sqrt(rate / size) / (2 * np.pi):.2g} Hz",
        path,
        0.7 * speed,
    )
    path = low + (high - low) * np.round(3.0 * (_triangle(low, high, 0.3 * speed, time) - low) / (high - low)) / 3.0
    path = _limited(path, 0.5 * speed * h)
    yield moved("moves_and_rests", f"moves of {shown((high - low) / 3.0)} with rests between", path, 0.5 * speed)


def _triangle(low: float, high: float, speed: float, time: Array) -> Array:
    return low + (high - low) - np.abs(np.mod(speed * time + 0.5 * (high - low), 2.0 * (high - low)) - (high - low))


def _limited(path: Array, step: float) -> Array:
    found = path.copy()
    for k in range(1, len(found)):
        found[k] = found[k - 1] + min(max(path[k] - found[k - 1], -step), step)
    return found


def _usual_rates(measured: Measured, lead: int) -> tuple[float, float]:
    """Return the speed and the acceleration of a reading that the tests reach in a twentieth of the time."""
    columns = [one.readings[:, lead] for one in measured.tests]
    speeds = np.concatenate([np.abs(slope(one, HALF, measured.period)) for one in columns])
    rates = np.concatenate([np.abs(slope(one, 2 * HALF, measured.period, 2)) for one in columns])
    return float(np.percentile(speeds, 95.0)), float(np.percentile(rates, 90.0))
