"""One measure of the hidden-effect benchmark: its value, what is behind it, and what it is held against."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from benchmarks.hidden_effects.judging import Line


@dataclass(frozen=True)
class Aim:
    """What a measure is held against: the prototype's value as text, and (lowest, highest) allowed for good and the goal."""

    prototype: str = ""
    good: tuple[float, float] | None = None
    goal: tuple[float, float] | None = None


@dataclass(frozen=True)
class Measure:
    """One measure: its value, the number of cases behind it, a 95 % interval where it is a share, and who spoils it."""

    title: str
    value: float
    count: int
    aim: Aim = Aim()
    interval: tuple[float, float] | None = None
    unit: str = "%"
    spoiled: tuple[tuple[str, int], ...] = ()

    def meets(self, allowed: tuple[float, float] | None) -> bool:
        """Whether the value is in an allowed range."""
        return allowed is not None and allowed[0] <= self.value <= allowed[1]


def at_least(prototype: str, good: float, goal: float) -> Aim:
    """Return the aim of a measure of which more is better."""
    return Aim(prototype, (good, math.inf), (goal, math.inf))


def at_most(prototype: str, good: float, goal: float) -> Aim:
    """Return the aim of a measure of which less is better."""
    return Aim(prototype, (-math.inf, good), (-math.inf, goal))


def wilson(hits: int, total: int) -> tuple[float, float]:
    """Return the 95 % interval of a share in percent (Wilson 1927, doi:10.1080/01621459.1927.10502953)."""
    from scipy.stats import binomtest

    found = binomtest(hits, total).proportion_ci(method="wilson")
    return 100 * float(found.low), 100 * float(found.high)


def share(title: str, lines: Iterable[Line], hit: Callable[[Line], bool], aim: Aim = Aim()) -> Measure:
    """Return the share of the results that ``hit`` holds for."""
    chosen = list(lines)
    hits = [bool(hit(line)) for line in chosen]
    higher = aim.good is None or aim.good[1] > 100
    spoiled = Counter("+".join(one["effects"]) or "null" for one, ok in zip(chosen, hits, strict=True) if ok != higher)
    return counted(title, sum(hits), len(hits), aim, tuple(spoiled.most_common()))


def counted(title: str, hits: int, total: int, aim: Aim, spoiled: tuple[tuple[str, int], ...] = ()) -> Measure:
    """Return a share from its counts."""
    if not total:
        return Measure(title, math.nan, 0, aim)
    return Measure(title, 100 * hits / total, total, aim, wilson(hits, total), spoiled=spoiled)
