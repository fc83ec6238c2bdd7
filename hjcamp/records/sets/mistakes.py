"""What may have gone wrong with the columns of one log: a sign, two columns exchanged, time, a unit, a gain, a zero, a beginning."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from hjcamp.records.of_plant import span
from hjcamp.records.sets.course import Array, Course
from hjcamp.records.units import units_of


@dataclass(frozen=True)
class Mistake:
    """A log's ``columns`` with a mistake in ``fields`` undone, said as "agrees ...".

    ``fitted`` says that a number was chosen for it, ``skipped`` how many samples its repetitions have before it.
    """

    text: str
    columns: dict[str, Array]
    fields: tuple[str, ...]
    fitted: bool = False
    skipped: int = 0


def mistakes(one: Course, rest: Sequence[Course], far: Sequence[str]) -> Iterator[Mistake]:
    """Yield the mistakes that may have made columns ``far`` from the repetitions ``rest``, those without a free number first."""
    own = one.columns
    for name in far:
        yield Mistake("with the other sign", {**own, name: -own[name]}, (name,))
    units = {name: one.log.table.field(name).unit for name in own}
    for a, b in combinations(one.measured, 2):
        if units[a] == units[b] and (a in far or b in far):
            yield Mistake(f"with '{a}' and '{b}' exchanged", {**own, a: own[b], b: own[a]}, (a, b))
    yield Mistake("backwards in time", {name: values[::-1] for name, values in own.items()}, tuple(far))
    for times, text in ((2, "with every second row lost"), (0.5, "with every row written twice")):
        rows = np.arange(0.0, one.samples - 1, 1.0 / times)
        moved = {name: np.interp(rows, np.arange(one.samples), values) for name, values in own.items()}
        yield Mistake(f"{text}, or with a period {times:g} times as long", moved, tuple(far))
    for name in far:
        for unit, known in units_of(one.log.table.field(name)).items():
            if not known.shift and known.factor != 1.0:
                yield Mistake(f"with {unit} read as {units[name]}", {**own, name: own[name] * known.factor}, (name,))
                yield Mistake(f"with {units[name]} read as {unit}", {**own, name: own[name] / known.factor}, (name,))
    yield from _fitted(one, rest, far, units)


def _fitted(one: Course, rest: Sequence[Course], far: Sequence[str], units: dict[str, str]) -> Iterator[Mistake]:
    for name in far:
        length = min(one.samples, *(other.samples for other in rest))
        own, usual = one.columns[name], np.mean([other.columns[name][:length] for other in rest], axis=0)
        added = float(np.mean(usual - own[:length]))
        yield Mistake(f"with {added:.4g} {units[name]} added", {**one.columns, name: own + added}, (name,), True)
        if (square := float(np.sum(own[:length] ** 2))) > 0.0:
            times = float(np.sum(usual * own[:length])) / square
            yield Mistake(f"times {times:.3g}", {**one.columns, name: times * own}, (name,), True)
        if late := _late(own[:length], usual):
            text = f"begun {span(abs(late) * one.log.period)} {'earlier' if late > 0 else 'later'}"
            moved = {key: values[max(late, 0) :] for key, values in one.columns.items()}
            yield Mistake(text, moved, tuple(far), True, max(-late, 0))


def _late(own: Array, usual: Array) -> int:
    """Return by how many samples ``own`` (n,) comes later than ``usual``, a quarter of them at most: where both differ least."""
    count = len(own)
    common = np.fft.irfft(np.fft.rfft(own, 2 * count) * np.conj(np.fft.rfft(usual, 2 * count)), 2 * count)
    a, b = (np.concatenate([[0.0], np.cumsum(one**2)]) for one in (own, usual))
    lags = np.arange(-(count // 4), count // 4 + 1)
    first, last = np.maximum(lags, 0), count + np.minimum(lags, 0)
    squares = a[last] - a[first] + b[last - lags] - b[first - lags] - 2.0 * common[lags]
    return int(lags[np.argmin(squares / (last - first))])
