"""Whether a model that explains windows is contradicted by whole tests: the longest horizon of its predictions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hjcamp.diagnosis.residuals.free_run import whole_error
from hjcamp.errors import plain

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.selection.scored import Scored


def contradicted(analysis: Analysis, model: Scored, delta: float) -> str:
    """Return in words which channel errs by more over whole tests with a model than with the base, by delta; else nothing.

    Tests are simulated from their first sample on, each begun where it fits best; where a model does not forget that they say nothing.
    """
    before, after = (whole_error(analysis.search.at(one.place).windows, one.fitted.candidate) for one in (analysis.base, model))
    if before is None or after is None:
        return ""
    grown = np.flatnonzero(before.rms <= (1.0 - delta) * after.rms)
    sensors = [analysis.measured.sensors[k] for k in grown]
    return ", ".join(
        f"{one.field.replace('_', ' ')} ({plain(before.rms[k] * one.scale, 3)} -> {plain(after.rms[k] * one.scale, 3)} {one.unit})"
        for k, one in zip(grown, sensors, strict=True)
    )
