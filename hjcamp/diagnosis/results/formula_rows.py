"""Formulas for the law that a diagnosis found without a form: which of them its curve is, and what each leaves on held-out blocks."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.shares import left_above, rms_ratio
from hjcamp.diagnosis.candidates.nonparametric_laws import ENDS
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
from hjcamp.diagnosis.decision.formulas import Curve, Found, formulas_of, proposed
from hjcamp.diagnosis.decision.free_curve import at_knots_with_slopes
from hjcamp.diagnosis.decision.verdict import Verdict
from hjcamp.diagnosis.estimation.intervals import covariance_of
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.levels import LEVEL, NO_FORMULA
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.effects._forms import FORMS, unit_of

Array = NDArray[np.float64]
FEWEST = 4


def formula_rows(analysis: Analysis, verdict: Verdict) -> dict[str, Any]:
    """Return up to three formulas for the first unknown's curve, SI; empty where there is none, or it has no one curve.

    ``none`` is true where even the best leaves more than the errors of the knots explain, at the ``level`` that is stated.
    """
    if verdict.term is None:
        return {}
    name = next(one for one in verdict.term.names if one in analysis.search.unknowns)
    known = analysis.search.unknowns[name]
    if known.apart:
        return {}
    law = _Law(analysis, verdict.term, known)
    found = formulas_of(law.curve) if len(law.curve.knots) >= FEWEST else []
    if not found:
        return {}
    best = max(found, key=lambda one: one.chance)
    return {
        "law": name,
        "driver": known.driven_by,
        "level": NO_FORMULA,
        "none": not best.fits,
        "p_value": best.chance,
        "compared": len(FORMS),
        "forms": [law.row(one) for one in proposed(found)],
    }


class _Law:
    """A non-parametric term of a model with what its formulas are held against."""

    def __init__(self, analysis: Analysis, model: Scored, known: Unknown) -> None:
        self.analysis, self.model, self.known = analysis, model, known
        fitted, blocks = model.fitted, analysis.search.blocks
        self.places = [k for k, one in enumerate(fitted.free) if one.effect == known.effect.name]
        x, y, self.slopes = at_knots_with_slopes(model, known)
        found = covariance_of(fitted, blocks)
        # the shape of the covariance is the information's, of full rank whatever the number of blocks; blocks say how large it is
        self.spread = np.linalg.pinv(fitted.information + np.diag(1.0 / found.allowed))
        ratios = np.diag(found.whole)[self.places] / np.maximum(np.diag(self.spread)[self.places], 1e-300)
        own = self.spread[np.ix_(self.places, self.places)] * max(1.0, float(np.median(ratios)))
        covariance = self.slopes @ own @ self.slopes.T
        covariance += 1e-9 * float(np.trace(covariance)) * np.eye(len(x)) / len(x)
        self.curve = Curve(x, y, covariance, len(np.unique(blocks)), analysis.search.visits_of(known))

    def row(self, one: Found) -> dict[str, Any]:
        """Return a formula as the answer has it."""
        from scipy.special import stdtrit

        form, model = one.form, self._with(one)
        y_unit, x_unit = (self.known.effect.parameters[name].unit for name in (self.known.amplitudes[0], ENDS[0]))
        reach = float(stdtrit(max(self.curve.blocks, 2) - 1, 1.0 - LEVEL / 2.0))
        half = reach * np.sqrt(np.maximum(np.diag(one.covariance), 0.0))
        return {
            "form": form.name,
            "words": form.words,
            "text": form.text,
            "latex": form.latex,
            "parameters": {
                name: {
                    "value": float(value),
                    "unit": unit_of(form, name, y_unit, x_unit),
                    "ci95": [float(value - wide), float(value + wide)],
                }
                for name, value, wide in zip(form.parameters, one.values, half, strict=True)
            },
            **({"reference": self.curve.reference, "x_unit": x_unit} if form.reference else {}),
            "p_value": one.chance,
            "fits": one.fits,
            "bic": one.bic,
            "left": rms_ratio(self.analysis, model, self.analysis.base),
            "left_above_repeatability": left_above(self.analysis, model, self.analysis.base),
            "taken": self._taken(model),
            "x": self.curve.knots.tolist(),
            "y": one.at_knots.tolist(),
        }

    def _with(self, one: Found) -> Scored:
        """Return the model with a formula in the place of its law, its features on held-out blocks to first order.

        What else is fitted follows the law as the information says: it is fitted again with the formula.
        """
        moved = np.linalg.lstsq(self.slopes, one.at_knots - self.curve.values, rcond=None)[0]
        own = self.spread[np.ix_(self.places, self.places)]
        step = self.spread[:, self.places] @ np.linalg.solve(own + 1e-12 * np.trace(own) * np.eye(len(own)), moved)
        features = self.model.features + np.einsum("wfp,p->wf", self.model.fitted.slopes, step)
        return replace(self.model, features=features, left_out=size(features))

    def _taken(self, model: Scored) -> float | None:
        """Return the share of the logarithm by which the law itself makes the held-out error smaller; None where it does not."""
        most = math.log(self.analysis.base.left_out / self.model.left_out)
        return math.log(self.analysis.base.left_out / model.left_out) / most if most > 0.0 else None
