"""What is said of readings that went wrong, each with the key of an import's map that helps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hjcamp.errors import counted
from hjcamp.records.glitches import Array, Places, freezes, no_readings, spikes, wraps

MISSING = "'missing: [NUMBER]', as it is in the file, and 'gaps: interpolate'"


def told_spikes(name: str, places: Places, values: Array, times: Array, unit: str) -> str:
    """Return in words that the readings at these places, one at least, jump out and back."""
    at = int(places[0])
    number = "a reading jumps" if len(places) == 1 else f"{len(places)} readings jump"
    before = f"{values[at - 1]:.4g}, then {values[at]:.4g}" if at else f"{values[at]:.4g}, the first reading,"
    first = f"{before} {unit} at {times[at]:.6g} s"
    return f"'{name}': {number} out and back by far more than any other step ({'first ' if len(places) > 1 else ''}{first})"


def told_no_readings(name: str, values: Array, unit: str) -> str:
    """Return in words that one value stands for no reading; empty where none does, or all of them are spikes."""
    places = no_readings(values)
    if not len(places) or np.isin(places, spikes(values)).all():
        return ""
    longest = max(map(len, np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)))
    return (
        f"'{name}' is {values[places[0]]:.6g} {unit} in {len(places)} samples, at most {longest} in a row, far outside of all others, "
        f"as where there is no reading: import with {MISSING} in the map"
    )


def told_glitches(
    name: str, values: Array, times: Array, unit: str, analog: bool, low: float, high: float
) -> Iterator[tuple[str, str]]:
    """Yield kinds of faults, each with which readings between ``low`` and ``high`` jump out and back, wrap around, or stay."""
    places = spikes(values)
    if len(places) and np.all((values[places] >= low) & (values[places] <= high)):
        text = f"{told_spikes(name, places, values, times, unit)}. Where the sensor or its logger erred, import with"
        yield "spikes", f"{text} 'spikes: interpolate' in the map"
    turns = wraps(values)
    if len(turns):
        at = int(turns[0])
        yield (
            "wraps",
            f"'{name}' jumps {counted(len(turns), 'time')} from one end of its range to the other and goes on, first from "
            f"{values[at - 1]:.4g} to {values[at]:.4g} {unit} at {times[at]:.6g} s, as a counter or an angle that wraps around: import "
            "with unwrap in the map next to its column, after how much it begins again (65536, 360)",
        )
    held = freezes(values) if analog else []
    if held:
        first, last = held[0]
        more = f", and {counted(len(held) - 1, 'time')} more" if len(held) > 1 else ""
        goes = ", to the end" if last == len(values) - 1 else ", and jumps on from there"
        until = f"{times[first]:.6g} to {times[last]:.6g} s{goes}"
        ends = values[first] in (values.min(), values.max())
        end = " (its smallest or largest value: the sensor may end there)" if ends else ""
        yield (
            "saturation" if ends else "stands still",
            f"'{name}' is {values[first]:.4g} {unit} in {last - first + 1} samples, {until}{more}{end}. "
            "Where the sensor or its logger stood still, make two logs of it, before and after",
        )
