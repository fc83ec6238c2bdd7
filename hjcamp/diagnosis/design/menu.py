"""The menu of tests of any plant, made from what its measured tests show: what is given, or how it is to move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.measured_test import MeasuredTest
from hjcamp.diagnosis.data.tests import Measured
from hjcamp.diagnosis.design.motions import motions
from hjcamp.diagnosis.design.wanted import Wanted

Array = NDArray[np.float64]
CONDITIONS = 4
# A test for which something must be mounted, or that leaves what the logs visited, has to be a quarter better.
DEARER = 1.25
# What nothing drives differs from test to test by where it begins.
BEGUN = {
    0.5: ("half", "half as far from where"),
    -1.0: ("other_side", "as far on the other side of where"),
    1.5: ("farther", "1.5 times as far from where"),
}
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)


def menu(measured: Measured, samples: int, by_motion: bool) -> list[Wanted]:
    """Return the tests of the menu, each ``samples`` long: the measured ones changed, some of a known form, other given values.

    ``by_motion``: a loop that is not in the plant's equations holds the motion, so a test is how it is to move.
    """
    first = [places[0] for places in measured.conditions.values()]
    some = [first[k] for k in np.unique(np.linspace(0, len(first) - 1, min(CONDITIONS, len(first))).astype(int))]
    found = [one for place in some for one in _changed(measured, place, samples, by_motion)]
    longest = max(some, key=lambda place: measured.tests[place].samples)
    found += motions(measured, longest, samples) if by_motion else _courses(measured, longest, samples)
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
    """Yield a measured test as it was, smaller, larger, slower, faster, the other way round; begun elsewhere if nothing is driven."""
    test = measured.tests[place]
    steps = np.arange(samples, dtype=float)
    inputs, readings = _cut(test, steps, samples)
    called, said = test.condition, test.condition or test.name
    plain = Wanted(f"{called}_again", f"{said} once more", place, inputs, readings, test.given)
    yield plain
    if not np.any(np.ptp(np.concatenate([one.inputs for one in measured.tests]), axis=0) > 0.0):
        for begun, (word, where) in {} if by_motion else BEGUN.items():
            cost = DEARER if begun > 1.0 else 1.0
            text = f"{said}, begun {where} it ends"
            yield replace(plain, name=f"{called}_{word}", text=text, changes={"begun": begun}, begun=begun, cost=cost)
        return
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
    # an input that rests in all tests, or is switched, stays as it is
    rests = np.array([not by_motion and (np.ptp(whole[:, k]) == 0.0 or _switched(measured, k)) for k in range(whole.shape[1])])
    for word, size in sizes.items():
        other = np.where(rests, own, middle + size * (own - middle))
        yield _with(plain, by_motion, other, f"{called}_{word}", f"{said} at {100 * size:.0f} % of its size", {"size": size})
    mirrored = np.where(rests, own, 2.0 * middle - own)
    if by_motion or np.all(mirrored >= low - 1e-9 * np.abs(low)):
        yield _with(plain, by_motion, mirrored, f"{called}_mirrored", f"{said} with its directions exchanged", {"size": -1.0})
    for word, factor in (("slower", 0.5), ("faster", 1.5)):
        inputs, readings = _cut(test, factor * steps, samples)
        text = f"{said}, {word} ({100 * factor:.0f} % of its speed)"
        yield replace(plain, name=f"{called}_{word}", text=text, inputs=inputs, readings=readings, changes={"speed": factor})


def _switched(measured: Measured, k: int) -> bool:
    """Whether an input has two values alone, and goes from one to the other within a test."""
    columns = [one.inputs[:, k] for one in measured.tests]
    return len(np.unique(np.concatenate(columns))) <= 2 and any(np.ptp(one) > 0.0 for one in columns)


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


def _courses(measured: Measured, place: int, samples: int) -> Iterator[Wanted]:
    """Yield courses of each input within its measured range: constant at several levels, steps, slow and quick to and fro, none."""
    names = [name for name in measured.plant.inputs if name not in ("time", "direction")]
    whole = np.concatenate([one.inputs for one in measured.tests])
    test, seconds = measured.tests[place], samples * measured.period
    usual = np.median(test.inputs, axis=0)
    fullest = int(np.argmax(test.readings[:, 0]))
    for k, name in enumerate(names):
        low, high = whole[:, k].min(), whole[:, k].max()
        if high <= low or measured.plant.inputs[name].rate_of:
            continue
        item = measured.plant.inputs[name]
        switched = _switched(measured, k)

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
            return f"{value:.3g} {unit}".rstrip()

        nearest = min(at.values(), key=abs)
        yield course(
            "hold",
            f"{name} held at {shown(nearest)}, begun where {measured.sensors[0].quantity} was largest",
            [(nearest, seconds)],
            fullest,
        )
        for share in () if switched else (0.25, 0.5, 0.75):
            yield course(f"at_{share * 100:.0f}", f"{name} held at {shown(at[share])}", [(at[share], seconds)])
        stairs = [at[1.0], at[0.0]] if switched else [at[share] for share in (0.25, 0.5, 0.75, 1.0, 0.75, 0.5, 0.25, 0.0)]
        for word, count in (("steps", len(stairs)), ("quick_steps", 4 * len(stairs))):
            pieces = [(stairs[i % len(stairs)], seconds / count) for i in range(count)]
            yield course(word, f"{name} in {count} steps between {shown(low)} and {shown(high)}", pieces)
        if not switched:
            up = [(float(low + (high - low) * x), seconds / 60) for x in 1.0 - np.abs(np.linspace(-1.0, 1.0, 60))]
            yield course("up_and_down", f"{name} slowly up to {shown(high)} and down again", up)
