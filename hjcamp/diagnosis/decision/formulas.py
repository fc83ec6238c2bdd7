r"""Which formula a found curve is: engineers' forms fitted through the law's own straight pieces, with its covariance.

A non-parametric term has values at knots and is straight between them: of a law f it is the nearest such one where the tests were,
:math:`P f` with :math:`P = (H^T W H)^{-1} H^T W` for hats H at places of weight W. A form is fitted by

.. math:: \chi^2 = (P f - y)^T V^{-1} (P f - y)

for knots y with covariance V: to first order the fit to the data themselves through the residuals, every other parameter free
again (Seber & Wild 1989, Nonlinear Regression, section 2.1). Forms are ranked by BIC (Schwarz 1978, doi:10.1214/aos/1176344136);
where even the best leaves more than the knots' errors, :math:`F(m - p, C - 1)` over C blocks, none of them fits.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.levels import LEVEL, NO_FORMULA
from hjcamp.effects._forms import FORMS, Form

Array = NDArray[np.float64]
PROPOSED = 3
POLISHED = 3
PLACES = 24  # in each straight piece
# Weight of places that no test says it was at, of all.
LITTLE = 0.01
MOST_STARTS = 1000


@dataclass(frozen=True)
class Curve:
    """A law's values at ``knots`` (m,) with their covariance (m, m), SI, by so many ``blocks``.

    ``visits`` (n,) are where the tests were.
    """

    knots: Array
    values: Array
    covariance: Array
    blocks: int
    visits: Array

    @property
    def reference(self) -> float:
        """The largest size of the driver."""
        return float(np.abs(self.knots).max()) or 1.0

    @property
    def gap(self) -> float:
        """How far knots are apart."""
        return float(np.ptp(self.knots)) / max(len(self.knots) - 1, 1)


@dataclass(frozen=True, eq=False)
class Found:
    """A form with its parameters, their covariance, what it leaves (chi-square), its BIC, and its values at the knots (m,)."""

    form: Form
    values: Array
    covariance: Array
    chi_square: float
    bic: float
    chance: float
    at_knots: Array

    @property
    def fits(self) -> bool:
        """Whether the knots' own errors explain what it leaves."""
        return self.chance > NO_FORMULA


def _projector(curve: Curve) -> tuple[Array, Array]:
    """Return places (n,) where a form is looked at, and the matrix (m, n) from its values there to the law nearest to it.

    These are where the tests were, and a few of little weight in all pieces: a knot that was not seen is as what is beside it.
    """
    knots = curve.knots
    even = np.concatenate(
        [np.linspace(a, b, PLACES, endpoint=False) + 0.5 * (b - a) / PLACES for a, b in itertools.pairwise(knots)]
    )
    x = np.concatenate([even, curve.visits])
    hats = np.stack([np.interp(x, knots, one) for one in np.eye(len(knots))], axis=1)
    little = LITTLE if len(curve.visits) else 1.0
    weight = np.concatenate([np.full(len(even), little * max(len(curve.visits), 1) / len(even)), np.ones(len(curve.visits))])
    return x, np.linalg.solve(hats.T @ (weight[:, None] * hats), hats.T * weight)


class Fit:
    """Fits forms to one curve."""

    def __init__(self, curve: Curve) -> None:
        self.curve = curve
        self.x, self.projector = _projector(curve)
        lower = np.linalg.cholesky(curve.covariance)
        self.white = np.linalg.solve(lower, self.projector)
        self.target = np.linalg.solve(lower, curve.values)

    def predicted(self, form: Form, values: Sequence[float] | Array) -> Array:
        """Return the white values (m,) of a form at the knots."""
        return np.asarray(self.white @ form(self.x, values, self.curve.reference))

    def started(self, form: Form) -> Iterator[tuple[float, Array]]:
        """Yield chi-square and parameters of a form for each start of its shapes, the others found linearly."""
        low, high, gap = float(self.curve.knots[0]), float(self.curve.knots[-1]), self.curve.gap
        grids = [np.asarray(one.starts(low, high, gap)) for one in form.shapes.values()]
        grids = [grid if len(grid) else np.array([1.0]) for grid in grids]
        combinations = list(itertools.product(*grids))
        for chosen in combinations[:: max(len(combinations) // MOST_STARTS, 1)]:
            shapes = dict(zip(form.shapes, chosen, strict=True))
            columns = [
                self.predicted(form, [shapes.get(name, float(name == one)) for name in form.parameters]) for one in form.linear
            ]
            basis = np.stack(columns, axis=1)
            if not np.isfinite(basis).all():
                continue
            amounts = np.linalg.lstsq(basis, self.target, rcond=None)[0]
            known = shapes | dict(zip(form.linear, amounts, strict=True))
            left = self.target - basis @ amounts
            yield float(left @ left), np.array([known[name] for name in form.parameters], dtype=np.float64)

    def fitted(self, form: Form) -> Found | None:
        """Return a form as it fits best; None where nothing of it is a number, or the knots are too few for it."""
        from scipy.optimize import least_squares
        from scipy.special import fdtrc

        m, p = len(self.curve.knots), len(form.parameters)
        starts = sorted(self.started(form), key=lambda one: one[0])[:POLISHED] if m > p else []
        if not starts:
            return None
        least, values = starts[0]
        low, high, gap = float(self.curve.knots[0]), float(self.curve.knots[-1]), self.curve.gap
        ends = [
            form.shapes[name].bounds(low, high, gap) if name in form.shapes else (-math.inf, math.inf)
            for name in form.parameters
        ]
        if form.shapes:
            for _, start in starts:
                scale = np.where(start != 0.0, np.abs(start), 1.0)
                bounds = tuple(np.array(end) / scale for end in zip(*ends, strict=True))
                begin = np.clip(start / scale, bounds[0] + 1e-9, bounds[1] - 1e-9)

                def left(at: Array, scale: Array = scale) -> Array:
                    found = self.predicted(form, at * scale) - self.target
                    return found if np.isfinite(found).all() else np.full(m, 1e6)

                better = least_squares(left, begin, bounds=bounds, max_nfev=60)
                if 2.0 * better.cost < least:
                    least, values = 2.0 * float(better.cost), better.x * scale
        slopes = self._slopes(form, values)
        covariance: Array = np.asarray(np.linalg.pinv(slopes.T @ slopes), dtype=np.float64)
        blocks = max(self.curve.blocks, 2) - 1
        chance = float(fdtrc(m - p, blocks, least / (m - p)))
        # the covariance is that of so many blocks: Student's t, not a normal density
        bic = (blocks + m) * math.log1p(least / blocks) + p * math.log(m)
        at_knots = self.projector @ form(self.x, values, self.curve.reference)
        return Found(form, values, covariance * max(1.0, least / (m - p)), least, bic, chance, at_knots)

    def _slopes(self, form: Form, values: Array) -> Array:
        columns = []
        for k, value in enumerate(values):
            step = 1e-5 * (abs(value) or 1.0)
            ends = [self.predicted(form, values + sign * step * np.eye(len(values))[k]) for sign in (1.0, -1.0)]
            columns.append((ends[0] - ends[1]) / (2.0 * step))
        return np.nan_to_num(np.stack(columns, axis=1))


def formulas_of(curve: Curve) -> list[Found]:
    """Return the forms by BIC, the best first, each once: of two that say the same at the knots the one with fewer parameters."""
    fit = Fit(curve)
    found = [one for form in FORMS.values() if (one := fit.fitted(form)) is not None]
    kept: list[Found] = []
    for one in sorted(found, key=lambda each: (each.bic, len(each.values))):
        if not any(_same(one, other, curve) for other in kept):
            kept.append(one)
    return kept


def proposed(found: Sequence[Found]) -> list[Found]:
    """Return up to three of the forms that fit: the best by BIC, and the one with the fewest parameters that the knots do not rule out.

    Where none fits it is the nearest alone.
    """
    fitting = [one for one in found if one.fits]
    simplest = [one for one in sorted(fitting, key=lambda each: len(each.values)) if one.chance > LEVEL]
    kept = [*fitting[: PROPOSED - 1], *simplest[:1], *fitting]
    return list(dict.fromkeys(kept))[:PROPOSED] or list(found[:1])


def _same(one: Found, other: Found, curve: Curve) -> bool:
    """Whether two forms differ at the knots by less than a hundredth of these knots' errors: one says what the other says."""
    errors = np.sqrt(np.diag(curve.covariance))
    return bool(np.all(np.abs(one.at_knots - other.at_knots) <= 0.01 * errors)) and len(one.values) >= len(other.values)
