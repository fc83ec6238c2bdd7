"""Fit free parameters of a model to the windows by damped Gauss-Newton steps (Levenberg 1944; Marquardt 1963)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.estimation.bounded_step import bounded_step
from hjcamp.diagnosis.estimation.likelihood import loss, whitener
from hjcamp.diagnosis.residuals.windows import Place, Windows
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]
STEP = 0.01
ROUNDS = 12
# The starts are where they belong when moving them gains less.
SETTLED = 0.5
# So many turns of a fit and of its windows' starts at most: they end where nothing is gained.
TURNS = 20
GAINED = 0.05
# A step that promises less is not tried: it would move a parameter by a hundredth of its standard error.
PROMISED = 5e-5
WORST_DAMPING = 1e6
LEAST_DAMPING = 1e-9
# Slopes that are followed by secants are computed afresh where a step gains less, or must be damped more.
ENOUGH = 2.0
FARTHEST = 10.0


@dataclass(frozen=True)
class Free:
    """A free parameter: of the base (``effect`` empty) or of an effect; ``scale`` is its usual size, SI.

    ``spread`` is the standard deviation with which it is known beforehand about ``centre``, infinite where it is not; that of its
    logarithm where it is fitted so.
    """

    effect: str
    name: str
    scale: float
    low: float
    high: float
    log: bool = False
    spread: float = math.inf
    centre: float = 0.0

    def value_in(self, candidate: Candidate) -> float:
        """Return its value in a candidate, SI."""
        return candidate.effects[self.effect][self.name] if self.effect else candidate.base[self.name]

    def of(self, candidate: Candidate) -> float:
        """Return its value in a candidate, in units of its scale (its logarithm where it is fitted so)."""
        value = self.value_in(candidate)
        return math.log(max(value, 1e-300)) if self.log else value / self.scale

    def into(self, candidate: Candidate, x: float) -> Candidate:
        """Return the candidate with this value, in units of its scale (its logarithm), within the bounds."""
        return self.put(candidate, math.exp(min(x, 700.0)) if self.log else x * self.scale)

    def put(self, candidate: Candidate, value: float) -> Candidate:
        """Return the candidate with this value, SI, within the bounds."""
        value = float(min(max(value, self.low), self.high))
        if self.effect:
            return candidate.with_effect(self.effect, {**candidate.effects[self.effect], self.name: value})
        return candidate.with_base({self.name: value})

    def within(self, candidate: Candidate) -> Candidate:
        """Return the candidate with this value moved onto the nearer bound where it lies beyond one."""
        value = self.value_in(candidate)
        return candidate if self.low <= value <= self.high else self.into(candidate, self.of(candidate))

    def bounded(self, candidate: Candidate) -> bool:
        """Whether it stands at one of its bounds."""
        return self.value_in(candidate) in (self.low, self.high)

    def surprise(self, candidate: Candidate) -> float:
        """Return how many standard deviations it is from where it was known to be."""
        if not math.isfinite(self.spread):
            return 0.0
        return (self.of(candidate) - (math.log(self.centre) if self.log else self.centre / self.scale)) * self.slope

    @property
    def slope(self) -> float:
        """The change of ``surprise`` for one unit of x."""
        return (1.0 if self.log else self.scale) / self.spread if math.isfinite(self.spread) else 0.0


@dataclass(frozen=True)
class Fitted:
    """A fitted model with its features (windows, d), their slopes (windows, d, free) and its loss.

    ``place`` is where windows begin for it, where they were moved along.
    """

    candidate: Candidate
    free: tuple[Free, ...]
    features: Array
    slopes: Array
    loss: float
    place: Place | None = None

    @property
    def information(self) -> Array:
        """The Gauss-Newton matrix (free, free) in units of the scales."""
        w = whitener(self.features)
        white = np.einsum("wfp,fg->wgp", self.slopes, w)
        found = np.einsum("wgp,wgq->pq", white, white)
        return np.asarray(found + np.diag([one.slope**2 for one in self.free]))

    @property
    def of_readings(self) -> Fitted:
        """This fit as readings alone tell it: nothing is known of the base beforehand."""
        free = tuple(one if one.effect else replace(one, spread=math.inf) for one in self.free)
        return replace(self, free=free, loss=whole_loss(self.features, self.candidate, free))


def slopes_of(windows: Windows, candidate: Candidate, free: Sequence[Free], base: Array) -> Array:
    """Return the derivatives (windows, d, free) of the features by finite differences, inwards at a bound."""
    columns = []
    for one in free:
        x = one.of(candidate)
        step = STEP
        moved = one.into(candidate, x + step)
        if abs(one.of(moved) - x) < 0.5 * step:
            moved = one.into(candidate, x - step)
        change = one.of(moved) - x
        columns.append((windows.along(moved) - base) / change if change else np.zeros_like(base))
    # a parameter on the edge of where the model diverges is not moved
    return np.nan_to_num(np.stack(columns, axis=2), posinf=0.0, neginf=0.0) if columns else np.zeros((*base.shape, 0))


class _Quadratic(NamedTuple):
    """The loss about a candidate: Gauss-Newton matrix (free, free), way downhill (free,), room to both bounds (free,); in scales."""

    curvature: Array
    downhill: Array
    room: tuple[Array, Array]

    @classmethod
    def of(cls, features: Array, slopes: Array, candidate: Candidate, free: Sequence[Free]) -> _Quadratic:
        """Return it from features (windows, d), their slopes (windows, d, free) and what is known beforehand."""
        w = whitener(features)
        white, left = np.einsum("wfp,fg->wgp", slopes, w), features @ w
        surprise, pull = np.array([[one.surprise(candidate), one.slope] for one in free]).T
        curvature = np.einsum("wgp,wgq->pq", white, white) + np.diag(pull**2)
        return cls(curvature, -np.einsum("wgp,wg->p", white, left) - pull * surprise, room_of(free, candidate))

    def step(self, damping: float) -> Array:
        """Return the best step (free,) within the bounds, damped by the sizes of the parameters' curvatures."""
        own = np.diag(self.curvature)
        size = np.maximum(own, 1e-12 * max(float(own.max()), 1e-300))
        return bounded_step(self.curvature + damping * np.diag(size), self.downhill, *self.room)

    @property
    def promised(self) -> float:
        """By how much a step that is hardly damped makes the loss smaller."""
        return 0.5 * float(self.downhill @ self.step(LEAST_DAMPING))


def fit(
    windows: Windows,
    start: Candidate,
    free: Sequence[Free],
    rounds: int = ROUNDS,
    near: Fitted | None = None,
    exact: bool = True,
    features: Array | None = None,
    thorough: bool = True,
) -> Fitted:
    """Return the fit from ``start`` within its bounds; it never is worse than that. Window starts stay as they are.

    Slopes follow each step by a secant update (Broyden 1965, doi:10.1090/S0025-5718-1965-0198670-6). They are computed afresh
    where a step gains little, and once more where it gains nothing, if the fit is ``thorough``; ``near`` lends its own, ``exact``
    asks for fresh ones at the end. ``features`` are those of ``start`` where they are known.
    """
    candidate, damping = start, 1e-3
    for one in free:
        candidate = one.within(candidate)
    if features is None or candidate is not start:
        features = windows.along(candidate)
    current = whole_loss(features, candidate, free)
    slopes, fresh = _lent(windows, candidate, free, features, near)
    close = fresh  # whether no step since they were computed has gained much
    eased = False  # whether an undamped step is tried: damping by what readings tell holds what they do not tell
    for _ in range(rounds):
        if not free or not np.isfinite(current):
            break
        model, gained = _Quadratic.of(features, slopes, candidate, free), 0.0
        while damping < WORST_DAMPING:
            step = model.step(damping)
            if model.downhill @ step < PROMISED:
                break
            tried = moved_by(candidate, free, step)
            seen = windows.along(tried)
            value = whole_loss(seen, tried, free)
            if value < current:
                gained = current - value
                move = np.array([one.of(tried) - one.of(candidate) for one in free])
                slopes = slopes + (seen - features - slopes @ move)[:, :, None] * move / float(move @ move)
                candidate, features, current = tried, seen, value
                damping = max(damping * 0.1, LEAST_DAMPING)
                break
            damping *= 10.0
            if eased or (not fresh and damping > FARTHEST):
                break
        if gained < GAINED and (fresh or not thorough):
            if eased or not thorough or model.promised < GAINED:
                break
            eased, damping = True, LEAST_DAMPING
            continue
        fresh = eased = False
        if gained >= ENOUGH:
            close = False
        elif gained < GAINED or not close:
            slopes, damping, fresh, close = slopes_of(windows, candidate, free, features), min(damping, 1e-3), True, True
    if exact and not close and np.isfinite(current):
        slopes = slopes_of(windows, candidate, free, features)
    return Fitted(candidate, tuple(free), features, slopes, current)


def room_of(free: Sequence[Free], candidate: Candidate) -> tuple[Array, Array]:
    """Return how far each parameter can be moved down and up (free,) within its bounds, in units of its scale."""
    low, high = (np.array([one.of(one.put(candidate, end)) for one in free]) for end in (-math.inf, math.inf))
    now = np.array([one.of(candidate) for one in free])
    return np.minimum(low - now, 0.0), np.maximum(high - now, 0.0)


def moved_by(candidate: Candidate, free: Sequence[Free], step: Array) -> Candidate:
    """Return a candidate with its free parameters moved by a step (free,), in units of their scales."""
    for one, x in zip(free, step, strict=True):
        candidate = one.into(candidate, one.of(candidate) + float(x))
    return candidate


def _lent(windows: Windows, candidate: Candidate, free: Sequence[Free], base: Array, near: Fitted | None) -> tuple[Array, bool]:
    """Return slopes (windows, d, free), those of ``near`` where it has them, and whether all of them are fresh."""
    known = {(one.effect, one.name): k for k, one in enumerate(near.free)} if near else {}
    own = [one for one in free if (one.effect, one.name) not in known]
    found = iter(np.moveaxis(slopes_of(windows, candidate, own, base), 2, 0))
    columns = [
        near.slopes[:, :, known[one.effect, one.name]] if near and (one.effect, one.name) in known else next(found)
        for one in free
    ]
    return (np.stack(columns, axis=2) if columns else np.zeros((*base.shape, 0))), len(own) == len(free)


def settled(windows: Windows, start: Candidate, free: Sequence[Free], near: Fitted | None = None, turns: int = TURNS) -> Fitted:
    """Return the fit with the windows' starts moved along: fit, move the starts, and fit again until nothing is gained.

    Turns follow slopes by secants. In the end starts are moved once more, so that the residual is judged by what the starts of this
    very model explain, and slopes are computed afresh: while these promise a gain, and keep to it, the turns go on.
    """
    found, stood = fit(windows, start, free, near=near, exact=False), math.inf
    for _ in range(turns):
        if not np.isfinite(found.loss):
            return found
        before = found
        features = windows.move_starts(before.candidate, rounds=1)
        found = fit(windows, before.candidate, free, near=before, features=features, exact=False, thorough=False)
        gained = before.loss - found.loss
        # where states go on from window to window, starts that are moved may bend the loss upwards at first
        if gained >= SETTLED or (gained <= -SETTLED and windows.unseen.any()):
            continue
        found = _as_it_stands(windows, found)
        if promised(found) < SETTLED or stood - found.loss < SETTLED:
            return found
        stood = found.loss
        found = fit(windows, found.candidate, free, near=found, features=found.features, exact=False)
    return _as_it_stands(windows, found) if np.isfinite(found.loss) else found


def _as_it_stands(windows: Windows, found: Fitted) -> Fitted:
    """Return a fit with the windows' starts moved to it, and with slopes computed there."""
    features = windows.move_starts(found.candidate, rounds=1)
    slopes = slopes_of(windows, found.candidate, found.free, features)
    value = whole_loss(features, found.candidate, found.free)
    return replace(found, features=features, slopes=slopes, loss=value, place=windows.place)


def promised(found: Fitted) -> float:
    """Return by how much a Gauss-Newton step within the bounds promises to make the loss of a fit smaller."""
    if not found.free or not np.isfinite(found.loss):
        return 0.0
    return _Quadratic.of(found.features, found.slopes, found.candidate, found.free).promised


def whole_loss(features: Array, candidate: Candidate, free: Sequence[Free]) -> float:
    """Return the loss of features (windows, d), and of what is known of the free parameters beforehand."""
    return loss(features) + 0.5 * sum(one.surprise(candidate) ** 2 for one in free)
