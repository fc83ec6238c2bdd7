"""A base that differs from condition to condition: what one set of parameters leaves, one for each condition may take."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.estimation.gauss_newton import settled
from hjcamp.diagnosis.estimation.intervals import Interval, intervals
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.levels import MOST_OF_IT
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.diagnosis.residuals.windows import Place, Windows
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.diagnosis.validation.blocks import left_out

MOST_TOLD = 3


@dataclass(frozen=True)
class Differs:
    """A base fitted to each condition alone: what that leaves of blocks left out, and the parameters whose intervals lie apart.

    ``parameters`` has the interval of each in each condition, by their names; what differs most comes first.
    """

    left_out: float
    parameters: dict[str, dict[str, Interval]]


def differs_by_condition(analysis: Analysis, least: float, level: float) -> Differs | None:
    """Return what a base for each condition explains where that is most of what is removable (error ``least``), at a level.

    None where there is one condition, where a condition has less than two blocks, and where no parameter differs.
    """
    base, blocks, layout = analysis.base, analysis.search.blocks, analysis.windows.layout
    conditions = layout.measured.conditions
    rows = {name: np.isin(layout.of_test, tests) for name, tests in conditions.items()}
    if len(conditions) < 2 or any(len(np.unique(blocks[own])) < 2 for own in rows.values()):
        return None
    before = replace(
        base,
        features=layout.predictions(base.features),
        fitted=replace(base.fitted, features=layout.predictions(base.fitted.features)),
    )
    shown, features, found = before.fitted.features.copy(), before.features.copy(), {}
    for name, own in rows.items():
        windows = _of_tests(analysis.windows, base.place, conditions[name], own)
        windows.move_starts(base.fitted.candidate)
        fitted = settled(windows, base.fitted.candidate, base.fitted.free)
        if not np.isfinite(fitted.loss):
            return None
        shown[own], features[own] = fitted.features, left_out(windows, fitted, blocks[own])
        found[name] = {one.name: one for one in intervals(fitted, blocks[own]) if not one.effect}
    each = Scored(base.names, replace(base.fitted, features=shown), features, size(features), base.place)
    takes = math.log(size(before.features) / each.left_out) >= MOST_OF_IT * math.log(size(before.features) / least)
    if not takes or not analysis.search.beats(each, before, level):
        return None
    names = [one.name for one in base.fitted.free if not one.effect and not one.name.startswith(ZERO)]
    apart = {name: _apart([one[name] for one in found.values()]) for name in names}
    told = sorted((name for name in names if apart[name] > 1.0), key=lambda name: -apart[name])[:MOST_TOLD]
    return Differs(each.left_out, {name: {at: one[name] for at, one in found.items()} for name in told}) if told else None


def _of_tests(windows: Windows, place: Place, tests: Sequence[int], rows: NDArray[np.bool_]) -> Windows:
    """Return the windows at ``rows`` (windows,), those of some of the tests, where a ``place`` of all has them."""
    layout = replace(windows.layout, measured=windows.layout.measured.of(tests))
    remembered = {name: one[rows] for name, one in place.remembered.items()}
    slides = None if windows.slides is None else windows.slides[rows]
    return replace(windows, layout=layout, starts=place.starts[rows], slides=slides, remembered=remembered, balances=None)


def _apart(found: Sequence[Interval]) -> float:
    """Return how far the two intervals lie apart that do so most, over half their widths together; 1 where they touch."""
    told = [one for one in found if one.told]
    return max(
        (
            (high.value - low.value) / max(0.5 * (high.high - high.low + low.high - low.low), 1e-300)
            for high in told
            for low in told
        ),
        default=0.0,
    )
