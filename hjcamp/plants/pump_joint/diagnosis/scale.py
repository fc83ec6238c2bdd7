"""The one scale of all errors that are told: channels in their own units, over one floor for each set of logs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import HjcampError
from hjcamp.model.declare.candidate import Candidate
from hjcamp.plants.pump_joint.diagnosis.fitting.calibrate import calibrate
from hjcamp.plants.pump_joint.diagnosis.fitting.heldout import Fold
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import WINDOW, Evidence
from hjcamp.plants.pump_joint.diagnosis.measured.signals import PERIOD
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.replay import (
    CHANNELS,
    SCALES,
    ChannelError,
    Series,
    channel_error,
    noise_floor_of,
    replay,
)
from hjcamp.plants.pump_joint.diagnosis.residuals.views import Views

Array = NDArray[np.float64]
HEADLINE = ("arm_deg", "pressure1_mpa", "pressure2_mpa")
FIRST = "first_reading"


@dataclass(frozen=True)
class Scale:
    """The floor of a set of logs, which no model that is judged enters; all None where nothing was repeated.

    ``floors`` by channel in the log's units, ``spreads`` likewise of what was measured; ``features`` (channels,) of the
    residuals; ``horizon`` (k,) rad of the arm after a restart. ``reference`` is the published model calibrated on these
    logs: repetitions are told apart beside what it makes of the pump's own differences between them.
    """

    noise_floors: Mapping[str, float | None]
    spreads: Mapping[str, float]
    reference: Candidate | None = None
    features: Array | None = None
    horizon: Array | None = None

    @property
    def repeated(self) -> bool:
        """Whether there is a floor at all."""
        return any(noise_floor is not None for noise_floor in self.noise_floors.values())

    def score(self, errors: Mapping[str, ChannelError | None]) -> float:
        """Return the geometric mean over arm and lines of the error over the floor, or over the measurement's spread."""
        parts = []
        for name in HEADLINE:
            error = errors[name]
            assert error is not None
            parts.append(error.rms / (self.noise_floors.get(name) or max(self.spreads[name], 1e-12)))
        return float(np.exp(np.mean(np.log(np.maximum(parts, 1e-12)))))


@dataclass(frozen=True)
class Judged:
    """The errors of a model by channel and their score; NaN and none where it runs away.

    ``each`` is the error of every single test: root mean square over arm, lines and first reading, in floors. ``places`` are
    the tests by their positions in the evidence, ``of_tests`` the rms of each of them by channel, in the log's units; ``shared``
    what the repetitions of each condition have in common of it.
    """

    errors: Mapping[str, ChannelError | None]
    score: float
    each: tuple[float, ...] = ()
    places: tuple[int, ...] = ()
    of_tests: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    shared: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


def shared_by(parts: Sequence[Array]) -> float:
    r"""Return the rms that R repetitions (n,) share, beside which what they differ by cancels; NaN for a single one.

    .. math:: s^2 = \max\Bigl(\frac{1}{R (R - 1)\,n} \sum_{r \ne r'} e_r^T e_{r'},\ 0\Bigr)
    """
    if len(parts) < 2:
        return float("nan")
    block = np.array([one[: min(map(len, parts))] for one in parts])
    whole, each = np.sum(block.sum(axis=0) ** 2), np.sum(block**2)
    return float(np.sqrt(max(whole - each, 0.0) / (block.size * (len(parts) - 1))))


def fall_of(before: Judged, after: Judged) -> tuple[float, float]:
    """Return by how much the error of single tests falls, and the standard error of that: 0 for one test, NaN for none."""
    falls = np.array(before.each) - np.array(after.each) if len(before.each) == len(after.each) else np.zeros(0)
    if not len(falls):
        return float("nan"), float("nan")
    error = float(np.std(falls, ddof=1) / np.sqrt(len(falls))) if len(falls) > 1 else 0.0
    return float(falls.mean()), error


def scale_of(views: Views, calibrated: Candidate | None = None) -> Scale:
    """Return the scale of the logs of ``views``; ``calibrated`` is the published model calibrated on them, if it is known.

    What repetitions differ by as they were measured is no floor of a replay: a closed loop moves the pump against each
    difference, and the replay is given that pump. So the calibrated published model takes it into account.
    """
    evidence = views.evidence
    spreads = {
        name: float(np.std(evidence.joined(quantity)) * scale)
        for name, quantity, scale in zip(HEADLINE, ("arm", "pressure1", "pressure2"), SCALES, strict=True)
    }
    if not evidence.repeated:
        return Scale(dict.fromkeys(CHANNELS), spreads)
    features = Features(evidence)
    candidate = calibrated or calibrate(views, features)[0].candidate
    try:
        noise_floors = replay(views, "reference", candidate).own_floors
    except HjcampError:
        return Scale(dict.fromkeys(CHANNELS), spreads)
    if np.isfinite(evidence.homes).any():
        noise_floors = {**noise_floors, FIRST: float(evidence.home_scatter * SCALES[0])}
    residuals = views.residuals(candidate)
    windows = windows_of(evidence, residuals[:, 0])
    width = round(WINDOW / PERIOD)
    known = [noise_floor_of([one[:, k] for one in windows], evidence.conditions.values()) for k in range(width)]
    horizon = np.array([one or 0.0 for one in known]) if None not in known else None
    return Scale(noise_floors, spreads, candidate, features.noise_floor(features.of(residuals)), horizon)


def windows_of(evidence: Evidence, arm: Array) -> list[Array]:
    """Return the error of the arm (n,) in each test as (windows, samples of one)."""
    width = round(WINDOW / PERIOD)
    blocks = []
    for begin, end in zip(evidence.edges[:-1], evidence.edges[1:], strict=True):
        count = (end - begin) // width
        blocks.append(arm[begin : begin + count * width].reshape(count, width))
    return blocks


class Judge:
    """Judges candidates on tests that were not used to fit them: whole replays of what each fold holds out."""

    def __init__(self, views: Views, parts: Sequence[Fold], scale: Scale) -> None:
        self.scale, self._whole = scale, views
        self._parts = [(fold.held_out, Views(views.evidence.only(fold.held_out), views.effects, views.crew)) for fold in parts]

    def of(self, candidates: Sequence[Candidate]) -> Judged:
        """Return the errors of one candidate for each fold, all folds together."""
        every: dict[str, Series] = {name: ([], []) for name in CHANNELS}
        first: list[float] = []
        for (tests, views), candidate in zip(self._parts, candidates, strict=True):
            try:
                series = replay(views, "held out", candidate).series
            except HjcampError:
                return Judged(dict.fromkeys((*CHANNELS, FIRST)), float("nan"))
            for name, (left, measured) in series.items():
                every[name][0].extend(left)
                every[name][1].extend(measured)
            known = self._whole.evidence.homes[list(tests)]
            first += ((self._whole.shown_at_zero(candidate) - known) * SCALES[0]).tolist()
        noise_floors = self.scale.noise_floors
        errors = {name: channel_error(*one, noise_floors.get(name)) for name, one in every.items()}
        seen = np.array(first)[np.isfinite(first)]
        errors[FIRST] = channel_error([seen], [seen], noise_floors.get(FIRST)) if len(seen) else None
        if not self._parts:
            return Judged(errors, float("nan"))
        places = tuple(place for tests, _ in self._parts for place in tests)
        of_tests = {
            name: tuple(float(np.sqrt(np.mean(one**2))) for one in left)
            for name, (left, _) in every.items()
            if name in HEADLINE
        }
        conditions = [self._whole.evidence.tests[place].condition for place in places]
        shared = {
            name: {
                one: shared_by([left for left, other in zip(every[name][0], conditions, strict=True) if other == one])
                for one in dict.fromkeys(conditions)
            }
            for name in HEADLINE
        }
        return Judged(errors, self.scale.score(errors), self._each(every, first), places, of_tests, shared)

    def _each(self, every: Mapping[str, Series], first: Sequence[float]) -> tuple[float, ...]:
        """Return the error of every single test, in floors."""
        scale = self.scale
        over = [scale.noise_floors.get(name) or max(scale.spreads[name], 1e-12) for name in HEADLINE]
        squares = np.array(
            [[np.mean(left**2) / one**2 for left in every[name][0]] for name, one in zip(HEADLINE, over, strict=True)]
        )
        noise_floor = scale.noise_floors.get(FIRST)
        if noise_floor is not None:
            squares = np.vstack([squares, np.square(first) / noise_floor**2])
        return tuple(np.sqrt(np.nanmean(squares, axis=0)).tolist())
