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
    """A log's ``columns`` with a mistake in ``fields`` undone, said as "agrees ..."; ``fitted`` where a number was chosen for it."""

    text: str
    columns: dict[str, Array]
    fields: tuple[str, ...]
    fitted: bool = False


def of_another_condition(name: str) -> str:
    """Return in words that a log belongs to another condition."""
    return f"agrees with the tests of condition '{name}': its condition is wrong"


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
        late = _late(own[:length], usual)
        if late > 0:
            moved = {key: np.roll(values, -late)[: max(one.samples - late, 2)] for key, values in one.columns.items()}
            yield Mistake(f"{span(late * one.log.period)} earlier", moved, tuple(far), True)


def _late(own: Array, usual: Array) -> int:
    """Return by how many samples ``own`` (n,) comes later than ``usual``, a quarter of them at most."""
    count = len(own)
    a, b = own - own.mean(), usual - usual.mean()
    common = np.fft.irfft(np.fft.rfft(a, 2 * count) * np.conj(np.fft.rfft(b, 2 * count)), 2 * count)
    most = count // 4
    lags = np.concatenate([common[: most + 1], common[-most:]]) if most else common[:1]
    best = int(np.argmax(lags))
    return best if best <= most else best - len(lags)
