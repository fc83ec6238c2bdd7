"""What a non-parametric term says over its driver, with its 95 % band."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.candidates.nonparametric_laws import ENDS
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
from hjcamp.diagnosis.estimation.intervals import APART, Interval, covariance_of, intervals
from hjcamp.diagnosis.levels import LEVEL
from hjcamp.diagnosis.selection.scored import Scored

Array = NDArray[np.float64]
FEWEST = 40


def curve_of(analysis: Analysis, model: Scored, name: str) -> dict[str, Any]:
    """Return an unknown's law over its driver with its 95 % band, SI."""
    known = analysis.search.unknowns[name]
    # between two knots a law is straight
    pieces = len(known.amplitudes) - 1
    x = np.linspace(known.low, known.high, max(-(-FEWEST // pieces), 2) * pieces + 1)
    values, low, high = (_of_value if known.quantity == "value" else _of_place)(analysis, model, known, x)
    parameters = known.effect.parameters
    return {
        "x": x.tolist(),
        "x_unit": parameters[ENDS[0]].unit,
        "y": values.tolist(),
        "y_unit": parameters[known.amplitudes[0]].unit,
        "low": low.tolist(),
        "high": high.tolist(),
    }


def _of_place(analysis: Analysis, model: Scored, known: Unknown, x: Array) -> tuple[Array, Array, Array]:
    own = {one.name: one for one in intervals(model.fitted, analysis.search.blocks) if one.effect == known.effect.name}
    # a knot that was not visited is as those beside it
    seen = _seen(model, known)
    knots = np.linspace(known.low, known.high, len(known.amplitudes))[seen]
    rows = [own[knot] for knot, one in zip(known.amplitudes, seen, strict=True) if one]
    at = np.array(known.levels) if known.levels else x
    values, low, high = (
        np.interp(x, at, known.amount(np.interp(at, knots, [getattr(one, key if one.told else "value") for one in rows])))
        for key in ("value", "low", "high")
    )
    return values, low, high


def _of_value(analysis: Analysis, model: Scored, known: Unknown, x: Array) -> tuple[Array, Array, Array]:
    r"""Return by which share a parameter differs from its mean over the knots, and the ends of the band of that.

    .. math:: y(x) = f(x) / \bar f - 1, \quad f = 1 + h

    The parameter itself is free as well: what no driver changes is its own, and no reading tells it from the law's. The answer gives
    it as `mean_over_knots`.
    """
    fitted, blocks = model.fitted, analysis.search.blocks
    places = [k for k, one in enumerate(fitted.free) if one.effect == known.effect.name]
    scales = np.array([fitted.free[k].scale for k in places])
    at_knots = np.array([fitted.free[k].of(fitted.candidate) for k in places]) * scales
    knots, hats = _hats(model, known, np.linspace(known.low, known.high, len(places))), _hats(model, known, x)
    along, at_knots = hats @ at_knots, knots @ at_knots
    values, known_there = 1.0 + known.amount(along), 1.0 + known.amount(at_knots)
    mean = known_there.mean()
    step = 1e-6
    steep, steep_there = ((known.amount(h + step) - known.amount(h - step)) / (2.0 * step) for h in (along, at_knots))
    slopes = steep[:, None] * hats / mean - np.outer(values, steep_there @ knots) / (len(places) * mean**2)
    whole = covariance_of(fitted, blocks).whole[np.ix_(places, places)] * np.outer(scales, scales)
    half = _reach(analysis) * np.sqrt(np.maximum(np.einsum("xk,kl,xl->x", slopes, whole, slopes), 0.0))
    share = values / mean - 1.0
    return share, share - half, share + half


def mean_over_knots(analysis: Analysis, model: Scored, known: Unknown, own: Interval) -> Interval:
    r"""Return the mean over a law's knots of the parameter that it is of, about which its curve is drawn, with its 95 % interval.

    .. math:: \bar p = p\,\bar f, \quad f = 1 + h

    for p as it is fitted with the law, its ``own`` interval.
    """
    fitted, free = model.fitted, model.fitted.free
    places = [k for k, one in enumerate(free) if one.effect == known.effect.name]
    base = next(k for k, one in enumerate(free) if not one.effect and one.name == own.name)
    knots = _hats(model, known, np.linspace(known.low, known.high, len(places)))
    at_knots = knots @ np.array([free[k].value_in(fitted.candidate) for k in places])
    mean, value = float(np.mean(1.0 + known.amount(at_knots))), own.value
    slopes, step = np.zeros(len(free)), 1e-6
    slopes[base] = mean * (value if free[base].log else free[base].scale)
    steep = (known.amount(at_knots + step) - known.amount(at_knots - step)) / (2.0 * step)
    slopes[places] = value * (steep @ knots) * [free[k].scale for k in places] / len(places)
    variance = float(slopes @ covariance_of(fitted, analysis.search.blocks).whole @ slopes)
    half = _reach(analysis) * math.sqrt(max(variance, 0.0))
    return replace(own, value=value * mean, low=value * mean - half, high=value * mean + half, at_bound=False, told=True)


def _reach(analysis: Analysis) -> float:
    """Return how many standard deviations the half of a 95 % interval is."""
    from scipy.special import stdtrit

    return float(stdtrit(max(len(np.unique(analysis.search.blocks)), 2) - 1, 1.0 - LEVEL / 2.0))


def knots_of(analysis: Analysis, model: Scored, name: str) -> dict[str, list[float]]:
    """Return the places over the driver (SI) at which an unknown's law has its values, and these, about what its curve is about.

    What no reading depends on has the value of what is beside it. Of a driver with few values these are the places.
    """
    known = analysis.search.unknowns[name]
    own = model.fitted.candidate.effects[name]
    at_knots = np.array([own[knot] for knot in known.amplitudes])
    places = np.linspace(known.low, known.high, len(at_knots))
    at = np.array(known.levels) if known.levels else places
    values = known.amount(_hats(model, known, at) @ at_knots)
    if known.quantity == "value":
        values = (1.0 + values) / np.mean(1.0 + known.amount(_hats(model, known, places) @ at_knots)) - 1.0
    return {"x": at.tolist(), "y": values.tolist()}


def at_knots_with_slopes(model: Scored, known: Unknown) -> tuple[Array, Array, Array]:
    """Return the places (m,) at which a law was seen and its values there (m,), SI, and their slopes (m, knots).

    The slopes are over what is fitted, in units of its scales; a parameter's law is about its mean over the knots, as its curve is.
    """
    free = [one for one in model.fitted.free if one.effect == known.effect.name]
    scales = np.array([one.scale for one in free])
    even = np.linspace(known.low, known.high, len(free))
    x = np.array(known.levels) if known.levels else even[_seen(model, known)]
    hats, step = _hats(model, known, x), 1e-6
    along = hats @ (np.array([one.of(model.fitted.candidate) for one in free]) * scales)
    values = known.amount(along)
    slopes = ((known.amount(along + step) - known.amount(along - step)) / (2.0 * step))[:, None] * hats * scales
    if known.quantity == "value":
        # one more is known of it than its shape: its mean is the parameter's own
        mean = 1.0 + float(np.mean(values))
        slopes = (slopes - np.outer((1.0 + values) / mean, slopes.mean(axis=0))) / mean
        values = (1.0 + values) / mean - 1.0
    return x, values, slopes


def _hats(model: Scored, known: Unknown, x: Array) -> Array:
    """Return how much of the value at each knot a law has at ``x`` (n, knots), one that was not visited as those beside it."""
    seen = _seen(model, known)
    knots = np.linspace(known.low, known.high, len(seen))[seen]
    return np.stack([np.interp(x, knots, one[seen]) for one in np.eye(len(seen))], axis=1)


def _seen(model: Scored, known: Unknown) -> NDArray[np.bool_]:
    """Return on which knots (knots,) any reading depends; all of them where none does."""
    columns = [k for k, one in enumerate(model.fitted.free) if one.effect == known.effect.name]
    sizes = np.linalg.norm(model.fitted.slopes[:, :, columns], axis=(0, 1))
    found = sizes > APART * sizes.max(initial=0.0)
    return found if found.any() else np.ones(len(found), dtype=bool)
