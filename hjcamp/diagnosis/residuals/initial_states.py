"""Estimates of a plant's states from what is measured: observed states, and rates of observed states, by local parabolas."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.tests import Measured
from hjcamp.model.checks.place_checks import PlainModel
from hjcamp.model.declare.effect import Effect
from hjcamp.model.language.vocabulary import read_vocabulary

Array = NDArray[np.float64]
# Half lengths of the parabola, in samples: the shortest with which a rate is told to a fiftieth of its usual size.
HALVES = (2, 3, 4, 6, 8, 12, 16, 24, 32)
RATE_ERROR = 0.02
# A rate within so many standard deviations of its error is none.
AT_REST = 3.0


@cache
def rate_of(plant: Any) -> dict[str, str]:
    """Return for each state that is the rate of another one, by the plant's equations, that other state."""
    found = {}
    for line in read_vocabulary(plant).statements:
        if line.mark == "rate" and line.expression.startswith("s_") and line.expression[2:] in plant.states:
            found[line.expression[2:]] = line.target.removeprefix("d_").removeprefix("rate.")
    return found


def erring_sensors(plant: Any, effects: Mapping[str, type[Effect]]) -> dict[str, set[str]]:
    """Return for each channel that reads a state the effects, without a memory of their own, that change what it reads."""
    found: dict[str, set[str]] = {}
    for port in read_vocabulary(plant).ports.values():
        fields = [name for name, one in plant.measured.items() if one.of and port.names.get("reading") == one.sensor]
        names = {name for name, one in effects.items() if port.names.get("reading") in one.terms and not one.states}
        found |= dict.fromkeys(fields, names) if names else {}
    return found


def on_sensors(plant: Any, effects: Iterable[type[Effect]]) -> list[type[Effect]]:
    """Return those effects that change what a sensor reads."""
    readings = {port.names.get("reading") for port in read_vocabulary(plant).ports.values() if port.kind == "sensor"}
    return [one for one in effects if readings & set(one.terms)]


def estimated(measured: Measured) -> tuple[list[Array], Array]:
    """Return the states of each test (n, states) with NaN where nothing measured tells them, and each state's error (states,).

    An observed state is its sensor's reading, the rate of one the slope of a parabola over 2 m + 1 samples with
    the shortest m that tells it well (Savitzky & Golay 1964, doi:10.1021/ac60214a047). The velocity of a contact whose
    reading rests is 0.
    """
    plant: Any = measured.plant
    names = list(plant.states)
    shown = {k: shown_by(plant, one.field) for k, one in enumerate(measured.sensors) if plant.measured[one.field].of}
    seen = best_sensors(measured)
    held = {contact.velocity for contact in read_vocabulary(plant).contacts}
    error = np.full(len(names), np.nan)
    states = [np.full((test.samples, len(names)), np.nan) for test in measured.tests]
    for name, k in seen.items():
        zero, gain = shown[k]
        place, noise = names.index(name), float(measured.noise[k])
        error[place] = noise / abs(gain)
        for test, found in zip(measured.tests, states, strict=True):
            found[:, place] = (test.readings[:, k] - zero) / gain
        above = name
        order = 0
        while (above := next((rate for rate, of in rate_of(plant).items() if of == above), "")) and above not in seen:
            order += 1
            if order > 2:
                break
            half, deviation = _half(measured, k, order)
            error[names.index(above)] = deviation / abs(gain)
            for test, found in zip(measured.tests, states, strict=True):
                values = slope(test.readings[:, k], half, measured.period, order)
                if above in held:
                    values = np.where(_rests(test.readings[:, k], values, half, noise, deviation), 0.0, values)
                found[:, names.index(above)] = values / gain
    return states, error


def smoothed_over(measured: Measured) -> dict[str, int]:
    """Return over how many samples on either side the speeds are smoothed that are estimated from measured positions."""
    seen, above = best_sensors(measured), rate_of(measured.plant)  # type: ignore[arg-type]
    return {speed: _half(measured, seen[of], 1)[0] for speed, of in above.items() if of in seen and speed not in seen}


def best_sensors(measured: Measured) -> dict[str, int]:
    """Return for each state that a sensor shows the position of that which tells it best."""
    plant: Any = measured.plant
    seen: dict[str, int] = {}
    for k, one in enumerate(measured.sensors):
        of = plant.measured[one.field].of
        if of and (of not in seen or _error(measured, k) < _error(measured, seen[of])):
            seen[of] = k
    return seen


def _error(measured: Measured, k: int) -> float:
    """Return the noise of a sensor in units of the state that it shows."""
    plant: Any = measured.plant
    return float(measured.noise[k]) / abs(shown_by(plant, measured.sensors[k].field)[1])


@cache
def shown_by(plant: Any, field: str) -> tuple[float, float]:
    """Return what the sensor of a field reads where the state that it shows is 0, and for one unit of it; (0, 1) where it bends."""
    one, place = plant.measured[field], PlainModel(plant)
    size = plant.states[one.of].typical
    with np.errstate(all="ignore"):
        try:
            low, zero, high = (place.signals({one.of: x})[one.sensor] for x in (-size, 0.0, size))
        except (ArithmeticError, ValueError, KeyError):
            return 0.0, 1.0
    gain = (high - low) / (2.0 * size)
    straight = abs(high + low - 2.0 * zero) <= 1e-6 * (abs(high) + abs(low))
    return (zero, gain) if gain != 0.0 and np.isfinite(gain) and straight else (0.0, 1.0)


def slope(values: Array, half: int, period: float, order: int = 1) -> Array:
    """Return the first or second derivative (n,) of the parabola through 2 half + 1 readings (n,) about each."""
    steps = np.arange(-half, half + 1)[:, None] ** np.arange(4 if order > 1 else 3)[None, :]
    weights = np.linalg.pinv(steps.astype(float))[order] * (2.0 if order == 2 else 1.0) / period**order
    # both ends are gone on with by their own straight lines
    reach = min(half, len(values) - 1)
    front = 2.0 * values[0] - values[1 : reach + 1][::-1]
    back = 2.0 * values[-1] - values[-reach - 1 : -1][::-1]
    padded = np.concatenate([np.resize(front, half), values, np.resize(back, half)])
    return np.convolve(padded, weights[::-1], mode="valid")


def _half(measured: Measured, k: int, order: int) -> tuple[int, float]:
    """Return the half length for a derivative of sensor k, and the standard deviation of that derivative's noise."""
    noise = float(measured.noise[k])
    half, deviation = HALVES[0], np.inf
    for half in HALVES:
        steps = np.arange(-half, half + 1)[:, None] ** np.arange(4 if order > 1 else 3)[None, :]
        weights = np.linalg.pinv(steps.astype(float))[order] * (2.0 if order == 2 else 1.0) / measured.period**order
        deviation = noise * float(np.linalg.norm(weights))
        usual = np.sqrt(np.mean([np.mean(slope(t.readings[:, k], half, measured.period, order) ** 2) for t in measured.tests]))
        if deviation < RATE_ERROR * usual:
            break
    return half, deviation


def _rests(readings: Array, rate: Array, half: int, noise: float, deviation: float) -> NDArray[np.bool_]:
    """Return where a reading rests (n,): it changes by no more than its noise over the parabola, nor does its slope."""
    padded = np.pad(readings, half, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1)
    still = np.abs(windows[:, -1] - windows[:, 0]) < 2.0 * np.sqrt(2.0) * noise
    return np.asarray(still & (np.abs(rate) < AT_REST * deviation))
