"""Whether a model that explains windows is contradicted by whole tests: the longest horizon of its predictions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hjcamp.diagnosis.residuals.free_run import Whole, whole_error
from hjcamp.errors import plain

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.selection.scored import Scored


def whole_of(analysis: Analysis, model: Scored) -> Whole | None:
    """Return the error of a fitted model over whole tests; None where these are not looked at."""
    return whole_error(analysis.search.at(model.place).windows, model.fitted.candidate)


def contradicted(analysis: Analysis, model: Scored, delta: float) -> str:
    """Return in words which channel errs by more over whole tests with a model than with the base, by delta; else nothing.

    Tests are simulated from their first sample on, each begun where it fits best; where a model does not forget that they say nothing.
    """
    before, after = whole_of(analysis, analysis.base), whole_of(analysis, model)
    if before is None or after is None:
        return ""
    grown = np.flatnonzero(before.rms <= (1.0 - delta) * after.rms)
    sensors = [analysis.measured.sensors[k] for k in grown]
    return ", ".join(
        f"{one.field.replace('_', ' ')} ({plain(before.rms[k] * one.scale, 3)} -> {plain(after.rms[k] * one.scale, 3)} {one.unit})"
        for k, one in zip(grown, sensors, strict=True)
    )
