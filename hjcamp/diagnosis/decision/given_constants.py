"""Constants that the plant's file gives: with one of them fitted a base may leave as little as what was found."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.calibration.shares import held_out
from hjcamp.diagnosis.estimation.gauss_newton import Free, settled
from hjcamp.diagnosis.estimation.intervals import Interval, intervals
from hjcamp.diagnosis.levels import MOST_OF_IT
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.plant import Plant

# A constant without bounds of its own is looked for within so many times its value, to both sides.
WITHIN = 10.0
MOST_TOLD = 3


@dataclass(frozen=True)
class Constant:
    """A constant of the plant's file: its ``interval`` where it is fitted with the base, and what that leaves of blocks left out."""

    interval: Interval
    left_out: float


def constants_otherwise(analysis: Analysis, least: float, rival: Scored | None) -> tuple[Constant, ...]:
    """Return the constants of which one, fitted with the base, takes most of what is removable (error ``least``), as a rival does.

    The rival is what was found, a name or a non-parametric term; it must not predict better. What leaves least comes first.
    """
    search, base = analysis.search, analysis.base
    found = []
    for one in _given(analysis.measured.plant, {name for test in analysis.measured.tests for name, _ in test.given}):
        windows = copy.copy(analysis.windows)
        windows.place = base.place
        start = base.fitted.candidate.with_base({one.name: analysis.measured.plant.parameters[one.name].default})
        fitted = settled(windows, start, (*base.fitted.free, one))
        if not np.isfinite(fitted.loss):
            continue
        model = search.scored(fitted, windows)
        told = next(own for own in intervals(fitted, search.blocks) if own.name == one.name and not own.effect)
        takes = math.log(base.left_out / model.left_out) >= MOST_OF_IT * math.log(base.left_out / least)
        worse = rival is not None and search.beats(rival, model)
        if takes and told.told and not worse and search.beats(model, base):
            found.append(Constant(told, held_out(analysis, model)))
    return tuple(sorted(found, key=lambda one: one.left_out)[:MOST_TOLD])


def _given(plant: type[Plant], of_tests: set[str]) -> Iterator[Free]:
    """Yield what a plant's file gives once and for all; of what is 0 there nothing says how large it could be."""
    for name, item in plant.parameters.items():
        fitted = name in plant.base_parameters or item.given or item.each_test or name in of_tests
        if fitted or item.default == 0.0 or not math.isfinite(item.default):
            continue
        size = abs(item.default)
        ends = sorted((item.default / WITHIN, item.default * WITHIN))
        low, high = (own if math.isfinite(own) else end for own, end in zip(item.bounds, ends, strict=True))
        yield Free("", name, size, low, high, log=item.prior != "uniform" and low > 0.0)
