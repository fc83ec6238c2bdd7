"""Compare models with measured tests: errors by channel beside the floor, where they come from, when they are born."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import HjcampError, counted
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.fitting.calibrate import calibrate
from hjcamp.plants.pump_joint.diagnosis.localisation.where import Place, where
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.measured.signals import PERIOD
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.replay import ChannelError, Replay, replay
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views
from hjcamp.plants.pump_joint.diagnosis.scale import Scale, scale_of, windows_of

Array = NDArray[np.float64]
SCHEMA = "hjcamp.comparison/1"
Report = Callable[[str, float], None]


@dataclass(frozen=True)
class Horizon:
    """Error against the time since a restart from measured states: s, rms and floor of the arm (rad), each (k,)."""

    time: Array
    rms: Array
    noise_floor: Array | None

    @property
    def born(self) -> tuple[float, float] | None:
        """When a tenth and nine tenths of the window's excess are there (s), None without any excess."""
        excess = self.rms**2 - (0.0 if self.noise_floor is None else self.noise_floor**2)
        excess = np.maximum.accumulate(np.maximum(excess, 0.0))
        if not len(excess) or excess[-1] <= 0:
            return None
        early, late = (float(self.time[int(np.argmax(excess >= part * excess[-1]))]) for part in (0.1, 0.9))
        return early, late


@dataclass(frozen=True)
class Compared:
    """One model on the tests: replay, residuals (n, channels) of the views, features."""

    replay: Replay
    residuals: Array
    seen: Array
    horizon: Horizon
    places: list[Place]
    score: float

    @property
    def errors(self) -> dict[str, ChannelError | None]:
        """The error of every channel over the floor of all logs."""
        return self.replay.errors


@dataclass(frozen=True)
class Comparison:
    """All models on the same tests, and the last one with its base parameters calibrated (None where it is already,
    or where what these tests make of it runs away).

    ``lesser`` are the models that have effects, each without one of them.
    """

    models: list[Compared]
    calibrated: Compared | None
    lesser: list[Replay] = field(default_factory=list)


def compare(
    evidence: Evidence,
    effects: tuple[type[Effect], ...],
    models: Mapping[str, Candidate],
    calibrated: bool = True,
    report: Report = lambda text, share: None,
) -> Comparison:
    """Return every model on the same tests; unless ``calibrated``, the last one also after its base is calibrated.

    The floor is that of the logs, whatever is compared. The score is the geometric mean over arm and both pressures of
    the error over that floor (over the spread of the measurement where nothing was repeated): 1 is perfect, lower is
    better.
    """
    views, features = Views(evidence, effects), Features(evidence)
    asked, base, plain = dict(models), None, None
    if not calibrated:
        report("calibrating the base parameters", 0.1)
        name, last = list(models.items())[-1]
        base = f"{name}, calibrated"
        asked[base] = calibrate(views, features, start=last if last.effects else None)[0].candidate
        plain = None if last.effects else asked[base]
    report("finding what repetitions differ by", 0.2)
    scale = scale_of(views, plain)
    replays = {}
    for number, (name, candidate) in enumerate(asked.items()):
        report(f"replaying {counted(len(evidence.tests), 'test')}: {name}", 0.3 + 0.2 * number / len(asked))
        try:
            replays[name] = replay(views, name, candidate, scale.noise_floors)
        except HjcampError:
            if name != base:
                raise
    found = {}
    for number, (name, replayed) in enumerate(replays.items()):
        report(f"looking where it comes from: {name}", 0.5 + 0.2 * number / len(replays))
        residuals = views.residuals(asked[name])
        seen = features.of(residuals)
        places = where(features, seen, scale.features, replayed)
        horizon = horizon_of(evidence, residuals[:, 0], scale)
        found[name] = Compared(replayed, residuals, seen, horizon, places, scale.score(replayed.errors))
    lesser = without_one_effect(views, models, scale)
    return Comparison([found[name] for name in models], found.get(base) if base else None, lesser)


def without_one_effect(views: Views, models: Mapping[str, Candidate], scale: Scale) -> list[Replay]:
    """Return the replays of every model without each one of its effects; one that runs away is left out."""
    found = []
    for name, candidate in models.items():
        for effect in candidate.effects:
            with suppress(HjcampError):
                found.append(replay(views, f"{name} without {effect}", candidate.without([effect]), scale.noise_floors))
    return found


def horizon_of(evidence: Evidence, arm: Array, scale: Scale) -> Horizon:
    """Return the error of the arm (n,) against the time since the last restart of its window; empty where no test is so long."""
    square = np.concatenate([one**2 for one in windows_of(evidence, arm)])
    width = square.shape[1] if len(square) else 0
    rms: Array = np.sqrt(square.mean(axis=0)) if width else np.zeros(0)
    return Horizon(np.arange(width, dtype=np.float64) * PERIOD, rms, scale.horizon if width else None)


def answer(compared: Sequence[Compared], tests: int) -> dict[str, Any]:
    """Return the answer for programs, schema hjcamp.comparison/1; ``where`` is that of the model named last."""
    models = []
    for one in compared:
        error = {
            name: None if found is None else {"rms": found.rms, "floor": found.noise_floor, "r2": found.r2}
            for name, found in one.errors.items()
        }
        models.append({"name": one.replay.name, "tests": tests, "error": error, "score": one.score})
    return {"schema": SCHEMA, "models": models, "where": [place.row() for place in compared[-1].places]}
