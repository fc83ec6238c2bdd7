"""The repetitions of one condition as few points: mean and range over time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hjcamp.known_plants import usual_plant
from hjcamp.records.log import observed
from hjcamp.records.of_plant import PLANT_KEY
from hjcamp.report.runs.followed import ERROR, FOLLOWED, WANTED

if TYPE_CHECKING:
    from hjcamp.records.log import TestLog

Array = NDArray[np.float64]
MOST_POINTS = 400
SWINGS = 0.25
#: Of what a mean varies: by so much repetitions may differ from it.
ALIGNED = 0.5
#: Repetitions that are drawn one by one.
MOST_SINGLE = 6


@dataclass(frozen=True)
class Spread:
    """One signal of a condition: mean, lowest and highest of all repetitions, at the times of its parent.

    ``single`` are the repetitions one by one, the first in front, each at the same times; none are kept of one repetition.
    """

    mean: NDArray[np.float64]
    lowest: NDArray[np.float64]
    highest: NDArray[np.float64]
    single: tuple[NDArray[np.float64], ...] = ()

    @property
    def aligned(self) -> bool:
        """Whether repetitions differ from their mean by less than half of what that varies: else phases cancel in it."""
        if len(self.single) < 2:
            return True
        apart = np.sqrt(np.mean([(one - self.mean) ** 2 for one in self.single]))
        return bool(apart <= ALIGNED * np.std(self.mean))

    def swings(self, whole: float) -> bool:
        """Whether most points stand for more than a quarter of the range ``whole``: a line of means would hide it."""
        return bool(np.median(self.highest - self.lowest) > SWINGS * whole) if len(self.mean) else False


@dataclass(frozen=True)
class Condition:
    """The command phases of the repetitions of one condition, on common times (s); ``observed`` is what they are called."""

    name: str
    tests: int
    time: NDArray[np.float64]
    signals: Mapping[str, Spread]
    observed: str = "measured"

    @property
    def aligned(self) -> bool:
        """Whether the repetitions move together, judged by the error where there is one: a mean of those that do not shows no test."""
        judged = [ERROR] if ERROR in self.signals else [name for name in self.signals if name != WANTED]
        return all(self.signals[name].aligned for name in judged)

    def lines(self, name: str) -> tuple[NDArray[np.float64], tuple[NDArray[np.float64], ...]]:
        """Return what is drawn of a signal: the mean where repetitions align, else one repetition, and the others thin."""
        one = self.signals[name]
        return (one.mean, ()) if self.aligned or not one.single else (one.single[0], one.single[1:])

    @property
    def banded(self) -> bool:
        """Whether its signals have a range that a picture must show: repetitions, or swings too fast for its points."""
        return self.tests > 1 or any(
            one.swings(float(np.max(one.highest) - np.min(one.lowest))) for one in self.signals.values() if len(one.mean)
        )


class Gathering:
    """The repetitions of one condition, added one after the other; none of them is kept.

    Repetitions of different length are compared up to the end of the shortest, those without a command phase are left
    out; a signal counts where every repetition has it.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._tests = 0
        self._called: set[str] = set()
        self._time: Array = np.empty(0)
        #: Sum, lowest and highest of each signal, sample by sample.
        self._so_far: dict[str, tuple[Array, Array, Array]] = {}
        #: The first repetitions of each signal, each as (times, means) of stretches.
        self._single: dict[str, list[tuple[Array, Array]]] = {}

    def add(self, log: TestLog) -> None:
        """Add one repetition."""
        phase = with_error(log.command_phase)
        if not len(phase["time_s"]):
            return
        self._tests += 1
        self._called.add(observed([log]))
        if self._tests == 1:
            self._time = phase["time_s"].copy()
            signals = panels_known().SIGNALS
            there = [name for name in signals if name in phase]
            if log.metadata.get(PLANT_KEY):
                there += [name for name in phase if name not in (*signals, "time_s", "phase")]
            self._so_far = {name: (phase[name].copy(), phase[name].copy(), phase[name].copy()) for name in there}
            self._single = {name: [_condensed(phase, name)] for name in there if name != WANTED}
            return
        samples = min(len(self._time), len(phase["time_s"]))
        self._time = self._time[:samples]
        self._so_far = {
            name: (total[:samples], lowest[:samples], highest[:samples])
            for name, (total, lowest, highest) in self._so_far.items()
            if name in phase
        }
        for name, (total, lowest, highest) in self._so_far.items():
            values = phase[name][:samples]
            np.add(total, values, out=total)
            np.minimum(lowest, values, out=lowest)
            np.maximum(highest, values, out=highest)
            if name in self._single and self._tests <= MOST_SINGLE:
                self._single[name].append(_condensed(phase, name))

    def condition(self, most_points: int = MOST_POINTS) -> Condition:
        """Return mean and range of every signal over the repetitions, in at most ``most_points`` stretches of time.

        Peaks survive: each stretch keeps the lowest and highest sample of all repetitions.
        """
        size = max(1, -(-len(self._time) // most_points))
        time = stretches(self._time, size).mean(axis=-1) if len(self._time) else self._time
        signals = {
            name: Spread(
                stretches(total, size).mean(axis=-1) / self._tests,
                stretches(lowest, size).min(axis=-1),
                stretches(highest, size).max(axis=-1),
                self._apart(name, time),
            )
            for name, (total, lowest, highest) in self._so_far.items()
        }
        called = "simulated" if self._called == {"simulated"} else "measured"
        return Condition(self._name, self._tests, time, signals, called)

    def _apart(self, name: str, time: Array) -> tuple[Array, ...]:
        """Return the first repetitions of a signal one by one at common times; none of one alone."""
        courses = self._single.get(name, [])
        return tuple(np.interp(time, at, values) for at, values in courses) if len(courses) > 1 else ()


def gather(name: str, logs: Iterable[TestLog], most_points: int = MOST_POINTS) -> Condition:
    """Return the repetitions of one condition as `Gathering` condenses them."""
    gathering = Gathering(name)
    for log in logs:
        gathering.add(log)
    return gathering.condition(most_points)


def _condensed(phase: Mapping[str, NDArray[np.float64]], name: str) -> tuple[Array, Array]:
    """Return the times and the means of a signal in as many stretches as a picture shows."""
    size = max(1, -(-len(phase["time_s"]) // MOST_POINTS))
    return stretches(phase["time_s"], size).mean(axis=-1), stretches(phase[name], size).mean(axis=-1)


def with_error(phase: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Return the columns with the error = reference - what follows it added, where there is a reference."""
    there = {WANTED, FOLLOWED} <= set(phase)
    return {**phase, **({ERROR: phase[WANTED] - phase[FOLLOWED]} if there else {})}


def panels_known() -> ModuleType:
    """Return the usual plant's panels and the signals in them; signals of other names get a panel for each unit."""
    return usual_plant().own_room("panels")


def stretches(values: Array, size: int) -> Array:
    """Return ``values`` as rows of ``size`` samples; the last sample fills up the last row."""
    short = -len(values) % size
    filled = np.concatenate([values, np.full(short, values[-1])]) if short else values
    return filled.reshape(-1, size)
