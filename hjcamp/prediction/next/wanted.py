"""The menu of tests of any plant, made from what its measured tests show: what is given, or how it is to move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.prediction.measured import Measured, MeasuredTest
from hjcamp.prediction.starts import slope

Array = NDArray[np.float64]
CONDITIONS = 4
# Readings that follow the first one to this share of their variance are moved with it.
GEARED = 0.9
SPEEDS = {"slow": 0.08, "at middle speed": 0.4, "fast": 0.95}
# A test for which something must be mounted, or that leaves what the logs visited, has to be a quarter better.
DEARER = 1.25
HALF = 8
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)


@dataclass(frozen=True)
class Wanted:
    """A test that could be made: ``inputs`` (n, inputs) are given, or ``readings`` (n, sensors) are how it is to move, SI.

    ``of`` is the measured test whose start, or whose inputs, it takes; ``given`` are parameters of this test, ``changes`` says in
    numbers what is other than in the logs. ``pieces`` are (value, seconds) of one input, for a campaign.
    """

    name: str
    text: str
    of: int
    inputs: Array
    readings: Array
    given: tuple[tuple[str, float], ...] = ()
    changes: Mapping[str, float] = field(default_factory=dict)
    cost: float = 1.0
    start_at: int = 0
    pieces: tuple[tuple[float, float], ...] = ()
    driven: str = ""

    @property
    def samples(self) -> int:
        """Number of samples."""
        return len(self.inputs)


def menu(measured: Measured, samples: int, by_motion: bool) -> list[Wanted]:
    """Return the tests of the menu, each ``samples`` long: the measured ones changed, some of a known form, other given values.

    ``by_motion``: a loop that is not in the plant's equations holds the motion, so a test is how it is to move.
    """
    first = [places[0] for places in measured.conditions.values()]
    some = [first[k] for k in np.unique(np.linspace(0, len(first) - 1, min(CONDITIONS, len(first))).astype(int))]
    found = [one for place in some for one in _changed(measured, place, samples, by_motion)]
    longest = max(some, key=lambda place: measured.tests[place].samples)
    found += _moves(measured, longest, samples) if by_motion else _courses(measured, longest, samples)
    return found + [one for place in some[:2] for one in _other_values(measured, place, samples)]


def _cut(test: MeasuredTest, rows: Array, samples: int) -> tuple[Array, Array]:
    """Return inputs and readings at places between the samples of a test, there and back again where it is too short."""
    last = test.samples - 1
    rows = last - np.abs(np.mod(rows, 2 * last) - last)
    low = np.floor(rows).astype(int)
    part = (rows - low)[:, None]
    high = np.minimum(low + 1, last)
    return test.inputs[low], (1.0 - part) * test.readings[low] + part * test.readings[high]


def _changed(measured: Measured, place: int, samples: int, by_motion: bool) -> Iterator[Wanted]:
    """Yield a measured test as it was, smaller, larger, slower, faster and the other way round."""
    test = measured.tests[place]
    steps = np.arange(samples, dtype=float)
    inputs, readings = _cut(test, steps, samples)
    called, said = test.condition, test.condition or test.name
    plain = Wanted(f"{called}_again", f"{said} once more", place, inputs, readings, test.given)
    yield plain
    whole = np.concatenate([one.readings if by_motion else one.inputs for one in measured.tests])
    low, high = whole.min(axis=0), whole.max(axis=0)
    own = readings if by_motion else inputs
    middle = 0.5 * (own.min(axis=0) + own.max(axis=0)) if by_motion else np.zeros(own.shape[1])
    reach = np.where(own > middle, own - middle, middle - own).max(axis=0)
    room = np.where(
        reach > 0.0,
        np.minimum(high - middle, np.where(middle > low, middle - low, np.inf)) / np.maximum(reach, 1e-300),
        1.0,
    )
    most = float(np.min(room[np.ptp(own, axis=0) > 0.0], initial=np.inf))
    sizes = {"half": 0.5} | ({"full": most} if 1.1 < most < np.inf else {})
    for word, size in sizes.items():
        other = middle + size * (own - middle)
        yield _with(
            plain, by_motion, other, f"{called}_{word}", f"{said} at {100 * size:.0f} % of its size", {"size": size}
        )
    mirrored = 2.0 * middle - own
    if by_motion or np.all(mirrored >= low - 1e-9 * np.abs(low)):
        yield _with(
            plain, by_motion, mirrored, f"{called}_mirrored", f"{said} with its directions exchanged", {"size": -1.0}
        )
    for word, factor in (("slower", 0.5), ("faster", 1.5)):
        inputs, readings = _cut(test, factor * steps, samples)
        text = f"{said}, {word} ({100 * factor:.0f} % of its speed)"
        yield replace(
            plain, name=f"{called}_{word}", text=text, inputs=inputs, readings=readings, changes={"speed": factor}
        )


def _with(plain: Wanted, by_motion: bool, values: Array, name: str, text: str, changes: Mapping[str, float]) -> Wanted:
    new: dict[str, Any] = {"readings" if by_motion else "inputs": values}
    return replace(plain, name=name, text=text, changes=changes, **new)


def _other_values(measured: Measured, place: int, samples: int) -> Iterator[Wanted]:
    """Yield a measured test with other values of the parameters that its metadata give: those of other tests, else 50 % off."""
    test = measured.tests[place]
    inputs, readings = _cut(test, np.arange(samples, dtype=float), samples)
    for name, now in test.given:
        seen = sorted({dict(one.given).get(name, now) for one in measured.tests})
        tried = [value for value in (seen[0], seen[-1]) if value != now] if len(seen) > 1 else [0.5 * now, 1.5 * now]
        for value in tried:
            if value == now:
                continue
            item = measured.plant.parameters[name]
            text = f"{test.condition or test.name} with {name.replace('_', ' ')} {value:.3g} {item.unit}"
            given = tuple((key, value if key == name else old) for key, old in test.given)
            called = f"{test.condition}_{name}_{'more' if value > now else 'less'}"
            yield Wanted(called, text, place, inputs, readings, given, {name: value}, DEARER)


def _moves(measured: Measured, place: int, samples: int) -> Iterator[Wanted]:
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
        yield moved(
            name, f"to and fro between {shown(bottom)} and {shown(top)} at {shown(0.5 * speed)}/s", path, 0.5 * speed
        )
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


def _courses(measured: Measured, place: int, samples: int) -> Iterator[Wanted]:
    """Yield courses of each input within its measured range: constant at several levels, steps, slow and quick to and fro, none."""
    names = [name for name in measured.plant.inputs if name not in ("time", "direction")]
    whole = np.concatenate([one.inputs for one in measured.tests])
    test, seconds = measured.tests[place], samples * measured.period
    usual = np.median(test.inputs, axis=0)
    fullest = int(np.argmax(test.readings[:, 0]))
    for k, name in enumerate(names):
        low, high = whole[:, k].min(), whole[:, k].max()
        if high <= low:
            continue
        item = measured.plant.inputs[name]
        levels = np.unique(whole[:, k])
        switched = len(levels) <= 2

        def course(
            label: str, text: str, pieces: list[tuple[float, float]], start: int = 0, k: int = k, name: str = name
        ) -> Wanted:
            inputs = np.tile(usual, (samples, 1))
            ends = np.cumsum([length for _, length in pieces]) / measured.period
            rows = np.minimum(np.searchsorted(ends, np.arange(samples), side="right"), len(pieces) - 1)
            inputs[:, k] = np.array([value for value, _ in pieces])[rows]
            return Wanted(
                f"{name}_{label}", text, place, inputs, np.zeros((samples, len(measured.sensors))), test.given,
                start_at=start, pieces=tuple(pieces), driven=name,
            )  # fmt: skip

        at = {share: float(low + share * (high - low)) for share in SHARES}

        def shown(value: float, unit: str = item.unit) -> str:
            return f"{value:.3g} {unit}"

        nearest = min(at.values(), key=abs)
        yield course(
            "hold",
            f"{name} held at {shown(nearest)}, begun where {measured.sensors[0].quantity} was largest",
            [(nearest, seconds)],
            fullest,
        )
        for share in () if switched else (0.25, 0.5, 0.75):
            yield course(f"at_{share * 100:.0f}", f"{name} held at {shown(at[share])}", [(at[share], seconds)])
        stairs = (
            [at[1.0], at[0.0]] if switched else [at[share] for share in (0.25, 0.5, 0.75, 1.0, 0.75, 0.5, 0.25, 0.0)]
        )
        for word, count in (("steps", len(stairs)), ("quick_steps", 4 * len(stairs))):
            pieces = [(stairs[i % len(stairs)], seconds / count) for i in range(count)]
            yield course(word, f"{name} in {count} steps between {shown(low)} and {shown(high)}", pieces)
        if not switched:
            up = [(float(low + (high - low) * x), seconds / 60) for x in 1.0 - np.abs(np.linspace(-1.0, 1.0, 60))]
            yield course("up_and_down", f"{name} slowly up to {shown(high)} and down again", up)
