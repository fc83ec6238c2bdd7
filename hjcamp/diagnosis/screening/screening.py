"""Screen effects by finite responses: what each would gain in addition to the base, if it acted linearly, over a grid of its shapes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
from hjcamp.diagnosis.candidates.visited_range import Range
from hjcamp.diagnosis.estimation.gauss_newton import Fitted, Free
from hjcamp.diagnosis.estimation.likelihood import loss, whitener
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.diagnosis.screening.settings import amplitudes_of, far_off, neighbours_of, reach_of, shape_grid
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter

Array = NDArray[np.float64]
# Of what is probed: an effect that fits best so small promises nothing. A fit may find it smaller.
NEGLIGIBLE = 0.03
# A response is scaled down to the error at hand where it is more than this often as large: it would not be linear.
LARGE, UNSTABLE, SCALINGS = 2.0, 10.0, 4
# An unknown's knots are probed at this share of the usual size of what they add to.
SMALL = 0.05


@dataclass(frozen=True)
class Probe:
    """One effect at one setting of its shapes: its responses (windows, d, amplitudes) to ``sizes`` of its amplitudes."""

    effect: str
    setting: Mapping[str, float]
    amplitudes: tuple[str, ...]
    sizes: Array
    one_sided: bool
    responses: Array


@dataclass(frozen=True)
class ProbedModel:
    """The model in addition to which effects are probed, its features (windows, d), and how large the error at hand is (norm).

    It is the fitted model without the forms of contacts: what an effect changes is nearly the same, at a tenth of the time.
    """

    candidate: Candidate
    features: Array
    error: float

    @classmethod
    def of(cls, windows: Windows, fitted: Fitted) -> ProbedModel:
        """Return it for a fitted model."""
        error, candidate = float(np.linalg.norm(fitted.features)), fitted.candidate
        if not windows.forms & set(candidate.effects):
            return cls(candidate, fitted.features, error)
        plain = candidate.without(windows.forms)
        return cls(plain, windows.features(plain), error)

    def response(self, windows: Windows, effect: str, values: Mapping[str, float]) -> Array:
        """Return what an effect changes (windows, d)."""
        return windows.features(self.candidate.with_effect(effect, values)) - self.features


@dataclass(frozen=True)
class Promise:
    """What an effect promises: its gain (log-likelihood) if it acted linearly, and the model at which."""

    effect: str
    gain: float
    candidate: Candidate


def probes_of(windows: Windows, probed: ProbedModel, effect: type[Effect], visited: Mapping[str, Range]) -> Iterator[Probe]:
    """Yield the probes of a named effect; ``visited`` is as in `visited_shapes`."""
    for setting in shape_grid(effect, visited):
        yield from _probe(windows, probed, effect, setting)


def _probe(windows: Windows, probed: ProbedModel, effect: type[Effect], setting: Mapping[str, float]) -> Iterator[Probe]:
    """Yield the probe at one setting of the shapes, of each amplitude alone; none where the model diverges."""
    names, sizes, responses = amplitudes_of(effect), [], []
    values = {**effect.defaults(), **setting}
    absent = {name: effect.parameters[name].off or 0.0 for name in names[1:]}
    for name in names:
        item = effect.parameters[name]
        off = item.off or 0.0
        size = values[name] - off or 0.1 * reach_of(item)
        for _ in range(SCALINGS):
            own = {**values, **absent, names[0]: effect.parameters[names[0]].off or 0.0, name: off + size}
            response = probed.response(windows, effect.name, own)
            larger = float(np.linalg.norm(response) / probed.error)
            if larger <= LARGE or far_off(item):
                break
            size /= larger if math.isfinite(larger) else UNSTABLE
        sizes.append(size)
        responses.append(response)
    if np.all(np.isfinite(responses)):
        sided = len(names) == 1 and effect.parameters[names[0]].bounds[0] >= (effect.parameters[names[0]].off or 0.0)
        yield Probe(effect.name, values, names, np.array(sizes), sided, np.stack(responses, axis=2))


def refined(
    windows: Windows,
    probed: ProbedModel,
    projection: Projection,
    effect: type[Effect],
    first: Promise,
    visited: Mapping[str, Range],
) -> Promise:
    """Return a promise with the effect's shapes moved to where it promises most, in ever smaller steps (pattern search)."""
    best = first
    for share in (0.25, 0.12, 0.06):
        setting = {name: best.candidate.effects[effect.name][name] for name, item in effect.parameters.items() if item.shape}
        for tried in neighbours_of(effect, setting, share, visited):
            for probe in _probe(windows, probed, effect, tried):
                promise = projection.promise(probe, effect)
                best = promise if promise.gain > best.gain else best
    return best


def probes_of_unknown(windows: Windows, probed: ProbedModel, unknown: Unknown) -> Iterator[Probe]:
    """Yield the probe of an unknown: one response for each of its knots."""
    ends, size = unknown.ends, SMALL * unknown.usual
    columns = []
    for name in unknown.amplitudes:
        own = {**ends, **dict.fromkeys(unknown.amplitudes, 0.0), name: size}
        columns.append(probed.response(windows, unknown.effect.name, own))
    responses = np.stack(columns, axis=2)
    if np.all(np.isfinite(responses)):
        yield Probe(unknown.effect.name, ends, unknown.amplitudes, np.full(len(unknown.amplitudes), size), False, responses)


class Projection:
    """The features of a fitted model, white, without what its free parameters could still explain."""

    def __init__(self, fitted: Fitted) -> None:
        self.fitted = fitted
        self.whitener = whitener(fitted.features)
        self._back = np.linalg.inv(self.whitener)
        # what stands at a bound explains no more
        self._free = [k for k, one in enumerate(fitted.free) if not one.bounded(fitted.candidate)]
        white = np.einsum("wfp,fg->wgp", fitted.slopes[:, :, self._free], self.whitener)
        known = np.diag([fitted.free[k].slope for k in self._free])
        self._rows = known.shape[0]
        self._slopes = np.concatenate([white.reshape(fitted.features.size, len(self._free)), known])
        stacked = self._slopes
        u, s, _ = np.linalg.svd(stacked, full_matrices=False) if self._rows else (stacked, np.zeros(0), None)
        self._span = u[:, s > 1e-8 * s[0]] if len(s) and s[0] > 0.0 else np.zeros((len(stacked), 0))

    def free_of_base(self, features: Array) -> Array:
        """Return features (windows, d) or responses (windows, d, k), white and projected, as columns (n, k)."""
        shaped = features if features.ndim == 3 else features[:, :, None]
        return self.free_of_white(np.einsum("wfk,fg->wgk", shaped, self.whitener))

    def free_of_white(self, features: Array) -> Array:
        """Return features that are white already (windows, d, k), projected, as columns (n, k)."""
        white = features.reshape(-1, features.shape[2])
        full = np.concatenate([white, np.zeros((self._rows, white.shape[1]))])
        return np.asarray(full - self._span @ (self._span.T @ full))

    def basis(self, probe: Probe) -> Array:
        """Return an orthonormal basis (n, k) of what a probe adds."""
        columns = self.free_of_base(probe.responses)
        norms = np.linalg.norm(columns, axis=0)
        before = np.linalg.norm(np.einsum("wfk,fg->wgk", probe.responses, self.whitener).reshape(-1, columns.shape[1]), axis=0)
        keep = norms > 1e-3 * np.maximum(before, 1e-300)
        if not keep.any():
            return np.zeros((len(columns), 0))
        u, s, _ = np.linalg.svd(columns[:, keep] / norms[keep], full_matrices=False)
        return np.asarray(u[:, s > 1e-3 * s[0]])

    def promise(self, probe: Probe, effect: type[Effect]) -> Promise:
        """Return what a probe promises, its amplitudes within their bounds."""
        left = self.free_of_base(self.fitted.features)[:, 0]
        columns = self.free_of_base(probe.responses)
        parameters, share = dict(probe.setting), np.zeros(len(probe.sizes))
        free = np.ones(len(share), dtype=bool)
        for _ in range(len(share)):
            found = np.linalg.lstsq(columns[:, free], -left - columns[:, ~free] @ share[~free], rcond=1e-6)[0]
            share[free] = found
            bounded = np.array(
                [
                    _within(effect.parameters[name], x, size)
                    for name, x, size in zip(probe.amplitudes, share, probe.sizes, strict=True)
                ]
            )
            free &= bounded == share
            share = bounded
            if free.all() or not free.any():
                break
        for name, x, size in zip(probe.amplitudes, share, probe.sizes, strict=True):
            if not far_off(effect.parameters[name]):
                parameters[name] = (effect.parameters[name].off or 0.0) + float(x) * float(size)
        if np.all(np.abs(share) < NEGLIGIBLE):
            share[:] = 0.0
        after = left + columns @ share
        n = self.fitted.features.size
        gain = self._loss(left[:n]) - self._loss(after[:n])
        return Promise(probe.effect, gain if np.any(share != 0.0) else 0.0, self._with_share(probe, parameters, share))

    def _with_share(self, probe: Probe, parameters: dict[str, float], share: Array) -> Candidate:
        """Return the model with the effect, its other free parameters moved to where they fit best next to it."""
        fitted = self.fitted
        target = np.concatenate([((probe.responses @ share) @ self.whitener).ravel(), np.zeros(self._rows)])
        steps = np.linalg.lstsq(self._slopes, -target, rcond=1e-8)[0] if self._rows else np.zeros(len(self._free))
        candidate = fitted.candidate
        for k, step in zip(self._free, steps, strict=True):
            one = fitted.free[k]
            candidate = one.into(candidate, one.of(candidate) + float(np.clip(step, -1.0, 1.0)))
        return candidate.with_effect(probe.effect, parameters)

    def _loss(self, white: Array) -> float:
        # in white coordinates the sensors' noise is (whitener' whitener): the loss is that of the features
        return loss(white.reshape(self.fitted.features.shape) @ self._back)


def _within(item: Parameter, share: float, size: float) -> float:
    """Return the share of a probed size, no farther than the parameter's bounds."""
    off = item.off or 0.0
    return (min(max(off + share * size, item.bounds[0]), item.bounds[1]) - off) / size


def free_of_effect(effect: type[Effect]) -> list[Free]:
    """Return the free parameters of a named effect, each as small as its bounds allow."""
    found = []
    for name, item in effect.parameters.items():
        low, high = item.bounds
        log = item.prior != "uniform" and low > 0.0
        size = 0.1 * reach_of(item) if item.placed or item.default == 0.0 else abs(item.default)
        found.append(Free(effect.name, name, size, low, high, log))
    return found


def free_of_unknown(unknown: Unknown) -> list[Free]:
    """Return the free parameters of an unknown: its knots, each known beforehand to be about as large as what it adds to."""
    most = 1e3 * unknown.usual
    return [Free(unknown.effect.name, name, unknown.usual, -most, most, spread=unknown.usual) for name in unknown.amplitudes]
