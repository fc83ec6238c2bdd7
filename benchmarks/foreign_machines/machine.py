"""A machine of somebody else: its truth, what may hide in it, the plant that its user wrote, and the files of a case."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from truth.case_files import MeasuredLog, write_case_files
from truth.hidden_form import Form, find_form

Values = dict[str, float]
Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class Machine:
    """A machine: `measure` returns the columns of one log of a rig with these values.

    `plant` is the user's file with @name@ where a base value is declared; `rig` holds the true values (base and all else), or
    two ends between which each rig has its own. `fields` map the program's fields on columns.
    """

    name: str
    plant: str
    base: tuple[str, ...]
    rig: Mapping[str, float | tuple[float, float]]
    measure: Callable[[Values, np.random.Generator, np.random.Generator, int], Columns]
    fields: dict[str, str | dict[str, str | float]]
    samples: tuple[int, int]  # of one log; of each of three repetitions
    forms: tuple[Form[Values], ...]

    def write(self, folder: Path, effect: str, form: str, seed: int, one_log: bool, strength: str | float = 1.0) -> Path:
        """Write the case into `folder` and return the path of its sealed answer; see `truth.case_files`."""
        number = zlib.crc32(self.name.encode())
        chosen = find_form(self.forms, effect, form, seed)
        random = np.random.default_rng([seed, number, 1])
        rig = {k: float(random.uniform(*v)) if isinstance(v, tuple) else v for k, v in self.rig.items()}
        changes = chosen.build(rig, float(strength), np.random.default_rng([seed, number, 2]))
        logs = []
        for log in ("train",) if one_log else ("run1", "run2", "run3"):
            course = np.random.default_rng([seed, number, 3])  # repetitions have the same course
            chance = np.random.default_rng([seed, number, 4, zlib.crc32(log.encode())])
            columns = self.measure(rig | changes, course, chance, self.samples[0 if one_log else 1])
            logs.append(MeasuredLog(log, columns, {"condition": "a"}))
        course, chance = (np.random.default_rng([seed, number, k]) for k in (5, 6))
        held_out = self.measure(rig | changes, course, chance, self.samples[1])
        logs.append(MeasuredLog("held_out", held_out, {"condition": "held_out"}, held_out=True))
        answer: dict[str, Any] = {"plant": self.name, **chosen.answer(), "one_log": one_log, "seed": seed}
        answer |= {"changes": changes, "base": {name: rig[name] for name in self.base}}
        return write_case_files(folder, self.name, self.source(rig, seed), self.fields, logs, answer)

    def source(self, rig: Values, seed: int) -> str:
        """Return the user's plant: base values declared 10 to 40 % off, either way, with two digits."""
        random = np.random.default_rng([seed, zlib.crc32(self.name.encode()), 7])
        text = self.plant
        for name in self.base:
            off = 1.0 + random.uniform(0.1, 0.4) * random.choice([-0.7, 1.0])
            text = text.replace(f"@{name}@", f"{rig[name] * off:.2g}")
        return text


def march(
    rate: Callable[[list[float], float], list[float]],
    start: Sequence[float],
    period: float,
    count: int,
    drive: Callable[[int, list[float]], float],
    parts: int,
    after: Callable[[list[float]], None] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Integrate by Runge-Kutta's method of order 4, `parts` steps a sample, under an input that is held for a sample.

    Returns states (count, n) and inputs (count,). `after` mends a state in place after each step (a wall, a rest).
    """
    x, step = list(start), period / parts
    states, inputs = np.empty((count, len(x))), np.empty(count)
    for k in range(count):
        u = drive(k, x)
        states[k], inputs[k] = x, u
        for _ in range(parts):
            a = rate(x, u)
            b = rate([p + 0.5 * step * q for p, q in zip(x, a, strict=True)], u)
            c = rate([p + 0.5 * step * q for p, q in zip(x, b, strict=True)], u)
            d = rate([p + step * q for p, q in zip(x, c, strict=True)], u)
            x = [p + step / 6 * (e + 2 * f + 2 * g + h) for p, e, f, g, h in zip(x, a, b, c, d, strict=True)]
            if after is not None:
                after(x)
    return states, inputs


def read(values: np.ndarray, step: float, noise: float, chance: np.random.Generator) -> np.ndarray:
    """Return what a sensor with white noise and a step reads."""
    return step * np.round((values + chance.normal(0.0, noise, values.shape)) / step)


def multisine(course: np.random.Generator, count: int, period: float, low: float, high: float) -> np.ndarray:
    """Return a sum of twelve sines between two frequencies (Hz), of rms 1."""
    time = np.arange(count) * period
    frequencies = np.geomspace(low, high, 12) * course.uniform(0.93, 1.07, 12)
    waves = [np.sin(2 * np.pi * (f * time + course.random())) for f in frequencies]
    return np.sum(waves, axis=0) / np.sqrt(6.0)


def levels(course: np.random.Generator, count: int, shortest: int, longest: int, low: float, high: float) -> np.ndarray:
    """Return levels that are held for some samples each."""
    parts: list[np.ndarray] = []
    while sum(part.size for part in parts) < count:
        parts.append(np.full(int(course.integers(shortest, longest)), course.uniform(low, high)))
    return np.concatenate(parts)[:count]
