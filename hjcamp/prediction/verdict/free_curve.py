"""What a free law says over its driver, with its 95 % band."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.prediction.fitting.intervals import covariance_of, intervals
from hjcamp.prediction.laws.unknowns import Unknown
from hjcamp.prediction.levels import LEVEL
from hjcamp.prediction.selection.analysis import Analysis
from hjcamp.prediction.selection.scored import Scored

Array = NDArray[np.float64]
CURVE = 41


def curve_of(analysis: Analysis, model: Scored, name: str) -> dict[str, Any]:
    """Return an unknown's law over its driver with its 95 % band, SI."""
    known = analysis.search.unknowns[name]
    x = np.linspace(known.low, known.high, CURVE)
    values, low, high = (_of_value if known.quantity == "value" else _of_place)(analysis, model, known, x)
    parameters = known.effect.parameters
    return {
        "x": x.tolist(), "x_unit": parameters["low"].unit, "y": values.tolist(), "y_unit": parameters["a0"].unit,
        "low": low.tolist(), "high": high.tolist(),
    }  # fmt: skip


def _of_place(analysis: Analysis, model: Scored, known: Unknown, x: Array) -> tuple[Array, Array, Array]:
    own = {one.name: one for one in intervals(model.fitted, analysis.search.chapters) if one.effect == known.effect.name}
    knots = np.linspace(known.low, known.high, len(known.amplitudes))
    values, low, high = (
        # a knot that was not visited has no band of its own
        known.amount(np.interp(x, knots, [getattr(own[knot], key if own[knot].told else "value") for knot in known.amplitudes]))
        for key in ("value", "low", "high")
    )
    return values, low, high


def _of_value(analysis: Analysis, model: Scored, known: Unknown, x: Array) -> tuple[Array, Array, Array]:
    r"""Return by which share a parameter differs from its mean over the knots, and the ends of the band of that.

    .. math:: y(x) = f(x) / \bar f - 1, \quad f = 1 + h

    The parameter itself is free as well: what no driver changes is its own, and no reading tells it from the law's.
    """
    from scipy.special import stdtrit

    fitted, chapters = model.fitted, analysis.search.chapters
    places = [k for k, one in enumerate(fitted.free) if one.effect == known.effect.name]
    scales = np.array([fitted.free[k].scale for k in places])
    at_knots = np.array([fitted.free[k].of(fitted.candidate) for k in places]) * scales
    hats = np.stack([np.interp(x, np.linspace(known.low, known.high, len(places)), one) for one in np.eye(len(places))], axis=1)
    along = hats @ at_knots
    values, known_there = 1.0 + known.amount(along), 1.0 + known.amount(at_knots)
    mean = known_there.mean()
    step = 1e-6
    steep, steep_there = ((known.amount(h + step) - known.amount(h - step)) / (2.0 * step) for h in (along, at_knots))
    slopes = steep[:, None] * hats / mean - np.outer(values, steep_there) / (len(places) * mean**2)
    whole = covariance_of(fitted, chapters).whole[np.ix_(places, places)] * np.outer(scales, scales)
    count = max(len(np.unique(chapters)), 2)
    half = float(stdtrit(count - 1, 1.0 - LEVEL / 2.0)) * np.sqrt(np.maximum(np.einsum("xk,kl,xl->x", slopes, whole, slopes), 0.0))
    share = values / mean - 1.0
    return share, share - half, share + half


def knots_of(known: Unknown, values: Mapping[str, float]) -> dict[str, list[float]]:
    """Return the places over the driver (SI) at which an unknown's law has its values, and these."""
    places = np.linspace(known.low, known.high, len(known.amplitudes))
    return {"x": places.tolist(), "y": [float(known.amount(values[name])) for name in known.amplitudes]}
