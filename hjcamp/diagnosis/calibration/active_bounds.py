"""Base parameters that a bound keeps away from what is declared: often a wrong sign or unit."""

from __future__ import annotations

from hjcamp.diagnosis.estimation.gauss_newton import settled
from hjcamp.diagnosis.estimation.intervals import Interval, intervals, limited
from hjcamp.diagnosis.levels import LEVEL
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.selection.search import Search


def held_away(search: Search, base: Scored) -> tuple[str, ...]:
    """Return the base parameters of a calibrated ``base`` that stand at a bound, far from what is declared.

    The base with that parameter as declared has to fit worse (likelihood ratio at the level of all claims): at a bound an interval
    tells little, and nothing of two gains whose product alone is told.
    """
    plant = search.windows.layout.measured.plant
    parameters, names = plant.parameters, set(plant.base_parameters)
    return tuple(
        one.name
        for one in intervals(base.fitted, search.blocks)
        if not one.effect
        and one.name in names
        and limited({"value": one.value, "at_bound": one.at_bound, **one.row})
        and _away(search, base, one, parameters[one.name].default)
    )


def _away(search: Search, base: Scored, one: Interval, declared: float) -> bool:
    from scipy.special import chdtri

    if one.value == declared:
        return False
    fitted = base.fitted
    start, free = fitted.candidate.with_base({one.name: declared}), [each for each in fitted.free if each.name != one.name]
    own = search.windows.begun_for(start, base.place)
    return settled(own, start, free).loss > fitted.loss + 0.5 * float(chdtri(1, LEVEL))
