"""Fits of the base from several starts, and with samples in parts: the best optimum of the calibration."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.hidden_states import begin_hidden
from hjcamp.diagnosis.data.segments import Layout
from hjcamp.diagnosis.estimation.gauss_newton import SETTLED, TURNS, Fitted, fit, settled
from hjcamp.diagnosis.estimation.likelihood import loss
from hjcamp.diagnosis.levels import DELTA, FITTED_STARTS, LEVEL
from hjcamp.diagnosis.residuals.windows import Windows
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate

Array = NDArray[np.float64]


# Of short tests, and where errors are more than noise, the base begins with each parameter so many times smaller and larger, too.
BEGUN_APART = 4.0


# In so many parts samples are simulated.
PARTS = (2, 4)


def above_noise(layout: Layout, features: Array) -> bool:
    """Whether features (windows, d) are more than the noise of a sensor by chance: what leaves no more cannot be fitted better."""
    from scipy.special import gammaincinv

    each = layout.predictions(features).reshape(len(features), len(layout.measured.sensors), -1)
    # the sum of n squares of noise is chi-squared
    half = 0.5 * each[:, 0].size
    return bool(np.any(np.mean(each**2, axis=(0, 2)) > gammaincinv(half, 1.0 - LEVEL) / half))


def in_parts(windows: Windows, fitted: Fitted) -> Fitted:
    """Return a fit with samples simulated in as many parts as what is given between them asks for; ``windows`` are left so.

    An input that acts a fraction of a sample late, or runs on from sample to sample, is its mean over a sample. Where that differs
    from parts by a tenth of a sensor's noise (rms), and of what a model leaves that takes all that matters, these are simulated.
    """
    if not (windows.layout.ahead or any(name.startswith(DELAY) for name in fitted.candidate.base)):
        return fitted
    for parts in PARTS:
        finer = replace(windows, layout=replace(windows.layout, fine=parts))
        finer.place = windows.place
        left = windows.features(fitted.candidate)
        change, usual = (_rms(one, windows.layout) for one in (finer.features(fitted.candidate) - left, left))
        if not np.any(change > DELTA * np.maximum(1.0, DELTA * usual)):
            break
        windows.layout = finer.layout
        fitted = settled(windows, fitted.candidate, fitted.free)
    return fitted


def _rms(features: Array, layout: Layout) -> Array:
    """Return the rms of features (windows, d) of each sensor (sensors,)."""
    return np.asarray(
        np.sqrt(
            np.mean(layout.predictions(features).reshape(len(features), len(layout.measured.sensors), -1) ** 2, axis=(0, 2))
        )
    )


def best_begun(windows: Windows, begun: Candidate, fitted: Fitted, names: Iterable[str]) -> Fitted:
    """Return the best of a fit and those that begin with one of the named base parameters well below or above where that began.

    One fit may be far from the best, as with a resonance that is declared elsewhere; one that the tests do not tell from the first
    (likelihood ratio at the level of all claims) is no better. Starts race on some of the windows; those that are better there than
    the first fit are fitted to all. ``windows`` are left begun where the best has them.
    """
    from scipy.special import chdtri

    best, place, least = fitted, windows.place, fitted.loss - 0.5 * float(chdtri(1, LEVEL))
    for one in _raced(windows, begun, fitted, names):
        own = windows.begun_for(one, place)
        found = settled(own, one, fitted.free)
        if found.loss < min(best.loss, least):
            best, windows.place = found, own.place
    return best


def _raced(windows: Windows, begun: Candidate, fitted: Fitted, names: Iterable[str]) -> list[Candidate]:
    """Return the starts that lead to better than a fit on some of the windows, by more than chance; none that is stiff there.

    After a first fit of each from windows' starts as they are, those that are about where the fit is lead there. Of the others the
    better half goes on in each turn (successive halving: Jamieson & Talwalkar 2016, arXiv:1502.07943).
    """
    from scipy.special import chdtri

    windows.spare(fitted.candidate)
    some = windows.some()
    least = loss(some.move_starts(fitted.candidate)) - 0.5 * float(chdtri(len(fitted.free), LEVEL))

    def turned(start: Candidate, near: Fitted | None = None) -> Fitted:
        own = copy.copy(some)
        own.place = near.place if near and near.place else some.place
        features = own.move_starts(start, rounds=1)
        return replace(fit(own, start, fitted.free, near=near, exact=False, features=features), place=own.place)

    ends = [one for one in fitted.free if not one.effect and one.name in names]
    starts = [one.put(begun, factor * one.value_in(begun)) for one in ends for factor in (1.0 / BEGUN_APART, BEGUN_APART)]
    first = (turned(one) for one in starts if np.isfinite(some.predicted(one).readings).all())
    racing = [one for one in first if elsewhere(one.candidate, fitted.candidate, names)]
    while len(racing) > FITTED_STARTS:
        racing = sorted(racing, key=lambda one: one.loss)[: -(-len(racing) // 2)]
        racing = [turned(one.candidate, one) for one in racing]
    ended = [settled(some.begun_for(one.candidate, one.place or some.place), one.candidate, fitted.free) for one in racing]
    return [one.candidate for one in sorted(ended, key=lambda one: one.loss) if one.loss < least]


def elsewhere(one: Candidate, other: Candidate, names: Iterable[str]) -> bool:
    """Whether a base parameter is half as far off, on a logarithmic scale, as a base is begun apart."""
    pairs = [(one.base[name], other.base[name]) for name in names if name in one.base and name in other.base]
    return any(b and not BEGUN_APART**-0.5 < a / b < BEGUN_APART**0.5 for a, b in pairs)


def refitted_from_model_states(windows: Windows, fitted: Fitted) -> Fitted:
    """Return the better of a fit and one whose unseen states begin where the fitted model leads them, from each test's start on.

    Readings may tell such a state in more than one place, as a speed of which nothing but the size is measured: then it stays about
    where the declared parameters have led it. ``windows`` are left begun where the better has them.
    """
    if not windows.unseen.any() or windows.layout.memory or not np.isfinite(fitted.loss):
        return fitted
    for _ in range(TURNS):
        own = replace(windows)
        own.place = windows.place
        begin_hidden(own, fitted.candidate)
        own.move_starts(fitted.candidate)
        found = settled(own, fitted.candidate, fitted.free)
        if not found.loss < fitted.loss - SETTLED:
            break
        fitted, windows.place = found, own.place
    return fitted
