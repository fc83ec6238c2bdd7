"""How well each fitted parameter is known: the table next to the corner plot, in words, for any diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FITTED = ("parameter", "value", "95 %", "most correlated with", "correlation", "")
SAID = (
    "Lines hold 68 and 95 %, in standard errors from the value above each column. Their shape is the curvature of the fit: a "
    "correlation near 1 or -1 means that these tests hardly distinguish the two, and that each is known less well than both "
    "together. Standard errors are those of the intervals in the table: from how parts of the tests differ."
)


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter, SI: ``error`` is its standard error, ``effect`` is empty for one of the base."""

    effect: str
    label: str
    value: float
    unit: str
    ci95: tuple[float, float]
    error: float
    at_bound: bool


def how_well_known(found: Sequence[Estimate], correlation: Array) -> tuple[list[str], dict[str, str]]:
    """Return the parts of a page and the picture (by name) of fitted parameters; ``correlation`` (k, k) is of the fit.

    Nothing for no parameter, no picture for one alone. Of more than fit the picture: those of effects, then those most correlated.
    """
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.pictures.corner import MOST, draw_corner
    from hjcamp.report.wording.units import told_error

    if not found:
        return [], {}
    parts = [page.heading("How well each parameter is known"), page.table_of(FITTED, known_rows(found, correlation))]
    if len(found) < 2:
        return parts, {}
    drawn = sorted(_first(found, correlation)[:MOST])
    shown = [found[place] for place in drawn]
    values = [told_error(one.value, one.error, one.unit) for one in shown]
    picture = draw_corner([one.label for one in shown], values, correlation[np.ix_(drawn, drawn)])
    which = f": {len(drawn)} of {len(found)}, those of effects and those most correlated" if len(drawn) < len(found) else ""
    return [*parts, page.picture(f"Fitted parameters, two by two{which}", picture), page.note(SAID)], {"corner": picture}


def known_rows(found: Sequence[Estimate], correlation: Array) -> list[list[str]]:
    """Return the rows of the table: parameter, value, interval, which other is most like it, how much, what to mind."""
    from hjcamp.report.pictures.corner import SIMILAR, told_correlation
    from hjcamp.report.wording.units import told_estimate, told_interval

    rows, others = [], _with_others(correlation)
    for place, one in enumerate(found):
        estimate = {"value": one.value, "unit": one.unit, "ci95": one.ci95}
        row = [one.label, told_estimate(estimate), told_interval(estimate)]
        most, said = "", ""
        if len(found) > 1:
            other = int(np.argmax(others[place]))
            most, said = found[other].label, told_correlation(float(correlation[place, other]))
        similar = others[place].max() > SIMILAR
        rows.append([*row, most, said, "at its bound" if one.at_bound else "hardly distinguishable" if similar else ""])
    return rows


def _with_others(correlation: Array) -> Array:
    """Return sizes (k, k) of the correlations with others."""
    sizes = np.abs(correlation)
    np.fill_diagonal(sizes, -1.0)
    return np.asarray(sizes)


def _first(found: Sequence[Estimate], correlation: Array) -> list[int]:
    """Return the places of parameters in the order in which they deserve room."""
    most = _with_others(correlation).max(axis=1)
    return sorted(range(len(found)), key=lambda place: (not found[place].effect, -float(most[place])))
