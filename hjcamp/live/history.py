"""What the page shows of one test: means over short stretches of each channel, and how near each limit came."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.model.checks.watch import Term, Watch

Array = NDArray[np.float64]
STRETCH_S = 5e-3
MOST_ROWS = 4000
DIGITS = 6


def read_watch(told: Mapping[str, Any]) -> Watch:
    """Return a limit from its plain values."""
    low, high = (end if end is not None else side * np.inf for end, side in zip(told["phases"], (-1, 1), strict=True))
    terms = tuple(Term(**term) for term in told["terms"])
    return Watch(told["name"], told["unit"], terms, told["low"], told["high"], (low, high))


class Nearness:
    """How near a test came to one limit, from columns that arrive in parts."""

    def __init__(self, watch: Watch) -> None:
        self.watch = watch
        self.value: float | None = None
        self.lowest = self.highest = self.margin = None  # type: float | None

    def add(self, columns: Mapping[str, Array]) -> None:
        """Take samples in; the ``reach`` samples before them come first."""
        values = self.watch.values(columns)
        margin = self.watch.margin(values)
        found = values[np.isfinite(values)]
        self.value = float(found[-1]) if found.size else None
        if margin is None:
            return
        low, high = float(found.min()), float(found.max())
        self.lowest = low if self.lowest is None else min(self.lowest, low)
        self.highest = high if self.highest is None else max(self.highest, high)
        self.margin = margin if self.margin is None else min(self.margin, margin)

    def shown(self) -> dict[str, Any]:
        """Return plain values: now, lowest and highest so far, and the smallest margin so far."""
        now = {"value": self.value, "lowest": self.lowest, "highest": self.highest, "margin": self.margin}
        return {"name": self.watch.name, **{name: _short(value) for name, value in now.items()}}


class History:
    """One test: ``rows`` of [sample number, channel, ...], each a mean over ``stretch`` samples.

    Never more than ``MOST_ROWS``: then neighbours are joined, and ``serial`` says that all rows are new.
    A part that was dropped on the way leaves a row of None.
    """

    def __init__(self, names: Sequence[str], period: float, watches: Sequence[Mapping[str, Any]]) -> None:
        self.names = list(names)
        self.stretch = max(1, round(STRETCH_S / period))
        self.rows: list[list[float | None]] = []
        self.serial = 0
        self.first = -1
        self.phase: float | None = None
        self.samples = 0
        self.limits = [Nearness(read_watch(one)) for one in watches]
        self._reach = max((one.watch.reach for one in self.limits), default=0)
        self._tail: dict[str, Array] = {}
        self._waiting: Array = np.empty((0, len(self.names)))

    def add(self, columns: Mapping[str, Array], start: int, first: int) -> None:
        """Take in samples from number ``start`` on; ``first`` begins the command phase, -1 where that is not known yet."""
        self.first = first
        if start < self.samples or not columns:
            return
        if start > self.samples:
            self._gap(start)
        count = len(next(iter(columns.values())))
        table = np.column_stack([columns.get(name, np.full(count, np.nan)) for name in self.names])
        self._bin(table)
        self.samples = start + count
        if "phase" in columns:
            self.phase = float(columns["phase"][-1])
        joined = {name: np.concatenate([self._tail.get(name, values[:0]), values]) for name, values in columns.items()}
        for limit in self.limits:
            limit.add(joined)
        self._tail = {name: values[len(values) - min(self._reach, len(values)) :] for name, values in joined.items()}

    def _gap(self, start: int) -> None:
        if self.rows:
            self.rows.append([self.samples, *[None] * len(self.names)])
        self._waiting, self._tail = self._waiting[:0], {}
        self.samples = start

    def _bin(self, table: Array) -> None:
        table = np.concatenate([self._waiting, table])
        begin = self.samples - len(self._waiting)
        whole = len(table) // self.stretch
        means = table[: whole * self.stretch].reshape(whole, self.stretch, len(self.names)).mean(axis=1)
        for place, row in enumerate(means.tolist()):
            middle = begin + (place + 0.5) * self.stretch - 0.5
            self.rows.append([middle, *map(_short, row)])
        self._waiting = table[whole * self.stretch :]
        if len(self.rows) > MOST_ROWS:
            self._join()

    def _join(self) -> None:
        odd = self.rows[len(self.rows) // 2 * 2 :]
        pairs = zip(self.rows[::2], self.rows[1::2], strict=False)
        self.rows = [[_mean(*both) for both in zip(*pair, strict=True)] for pair in pairs]
        self.rows += odd
        self.stretch *= 2
        self.serial += 1

    def limits_shown(self) -> list[dict[str, Any]]:
        """Return how near each limit came."""
        return [limit.shown() for limit in self.limits]


def _short(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(f"{value:.{DIGITS}g}")


def _mean(one: float | None, other: float | None) -> float | None:
    return None if one is None or other is None else 0.5 * (one + other)
