"""Compare models with measured tests: errors by channel beside the floor, where they come from, when they are born."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.discrepancy.baseline import calibrate
from hjcamp.discrepancy.candidate import Candidate
from hjcamp.discrepancy.evidence import PERIOD, WINDOW, Evidence
from hjcamp.discrepancy.features import Features
from hjcamp.discrepancy.replay import ChannelError, Replay, floor_of, replay
from hjcamp.discrepancy.views import Views
from hjcamp.discrepancy.where import Place, where
from hjcamp.model.effect import Effect

Array = NDArray[np.float64]
SCHEMA = "hjcamp.comparison/1"
HEADLINE = ("arm_deg", "pressure1_mpa", "pressure2_mpa")
Report = Callable[[str, float], None]


@dataclass(frozen=True)
class Horizon:
    """Error against the time since a restart from measured states: s, rms and floor of the arm (rad), each (k,)."""

    time: Array
    rms: Array
    floor: Array | None

    @property
    def born(self) -> tuple[float, float] | None:
        """When a tenth and nine tenths of the window's excess are there (s), None without any excess."""
        excess = self.rms**2 - (0.0 if self.floor is None else self.floor**2)
        excess = np.maximum.accumulate(np.maximum(excess, 0.0))
        if excess[-1] <= 0:
            return None
        early, late = (float(self.time[int(np.argmax(excess >= part * excess[-1]))]) for part in (0.1, 0.9))
        return early, late


@dataclass(frozen=True)
class Compared:
    """One model on the tests: replay, errors over the shared floor, residuals (n, channels) of the views, features."""

    replay: Replay
    errors: dict[str, ChannelError | None]
    residuals: Array
    seen: Array
    floor: Array
    horizon: Horizon
    places: list[Place]
    score: float


@dataclass(frozen=True)
class Comparison:
    """All models on the same tests, and the last one with its base parameters calibrated (None where it is already)."""

    models: list[Compared]
    calibrated: Compared | None


def compare(
    evidence: Evidence,
    effects: tuple[type[Effect], ...],
    models: Mapping[str, Candidate],
    calibrated: bool = True,
    report: Report = lambda text, share: None,
) -> Comparison:
    """Return every model on the same tests; unless ``calibrated``, the last one also after its base is calibrated.

    Floors are the lowest of all models looked at: what repetitions do not share grows with a bad model. The score is the
    geometric mean over arm and both pressures of the error over that floor (over the spread of the measurement where
    nothing was repeated): 1 is perfect, lower is better.
    """
    views, features = Views(evidence, effects), Features(evidence)
    asked, base = dict(models), None
    if not calibrated:
        report("calibrating the base parameters", 0.1)
        name, last = list(models.items())[-1]
        base = f"{name}, calibrated"
        asked[base] = calibrate(views, features, start=last if last.effects else None)[0].candidate
    replays = {}
    for number, (name, candidate) in enumerate(asked.items()):
        report(f"replaying {len(evidence.tests)} tests: {name}", 0.3 + 0.2 * number / len(asked))
        replays[name] = replay(views, name, candidate)
    errors = over_lowest_floor(list(replays.values()))
    found = {}
    for number, (name, candidate) in enumerate(asked.items()):
        report(f"looking where it comes from: {name}", 0.5 + 0.2 * number / len(asked))
        residuals = views.residuals(candidate)
        seen = features.of(residuals)
        floor = features.floor(seen)
        places = where(features, seen, floor, replays[name])
        horizon, score = horizon_of(evidence, residuals[:, 0]), score_of(replays[name], errors[name])
        found[name] = Compared(replays[name], errors[name], residuals, seen, floor, horizon, places, score)
    return Comparison([found[name] for name in models], found[base] if base else None)


def over_lowest_floor(replays: Sequence[Replay]) -> dict[str, dict[str, ChannelError | None]]:
    """Return the errors of every replay by name, each channel with the lowest floor of all of them."""
    least: dict[str, float] = {}
    for one in replays:
        for name, error in one.errors.items():
            if error is not None and error.floor is not None:
                least[name] = min(error.floor, least.get(name, error.floor))
    return {
        one.name: {
            name: None if error is None else replace(error, floor=least.get(name)) for name, error in one.errors.items()
        }
        for one in replays
    }


def score_of(one: Replay, errors: Mapping[str, ChannelError | None]) -> float:
    """Return the score of one replay from its errors over the shared floor."""
    parts = []
    for index, name in enumerate(HEADLINE):
        error = errors[name]
        assert error is not None
        parts.append(error.rms / (error.floor or max(float(np.std(one.measured[:, index])), 1e-12)))
    return float(np.exp(np.mean(np.log(np.maximum(parts, 1e-12)))))


def horizon_of(evidence: Evidence, arm: Array) -> Horizon:
    """Return the error of the arm (n,) against the time since the last restart of its window."""
    width = round(WINDOW / PERIOD)
    blocks: list[Array] = []
    for begin, end in zip(evidence.edges[:-1], evidence.edges[1:], strict=True):
        count = (end - begin) // width
        blocks.append(arm[begin : begin + count * width].reshape(count, width))
    square = np.concatenate([one**2 for one in blocks])
    floors = [floor_of([one[:, k] for one in blocks], evidence.conditions.values()) for k in range(width)]
    known = [one for one in floors if one is not None]
    floor = np.array(known) if len(known) == width else None
    rms: Array = np.asarray(np.sqrt(square.mean(axis=0)))
    return Horizon(np.arange(width, dtype=np.float64) * PERIOD, rms, floor)


def answer(compared: Sequence[Compared], tests: int) -> dict[str, Any]:
    """Return the answer for programs, schema hjcamp.comparison/1; ``where`` is that of the model named last."""
    models = []
    for one in compared:
        error = {
            name: None if found is None else {"rms": found.rms, "floor": found.floor, "r2": found.r2}
            for name, found in one.errors.items()
        }
        models.append({"name": one.replay.name, "tests": tests, "error": error, "score": one.score})
    return {"schema": SCHEMA, "models": models, "where": [place.row() for place in compared[-1].places]}
