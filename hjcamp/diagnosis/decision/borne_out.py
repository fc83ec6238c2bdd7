"""What short tests say where they are simulated from their first sample on: windows may be too short for what acts slowly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.levels import MATTERS, MOST_OF_IT
from hjcamp.diagnosis.residuals.free_run import through
from hjcamp.diagnosis.selection.scored import Scored, Step
from hjcamp.errors import plain

TOO_SHORT = ": these windows are too short for what acts slowly; longer tests, or repeated ones"


def not_borne_out(analysis: Analysis, first: Step, free: Scored) -> str:
    """Return in words that whole short tests contradict a free law that windows show; empty where they do not.

    So it is where the law leaves more than the base does there, and a name that takes what matters in windows leaves less.
    """
    named = [one for one in first.named if analysis.search.error_ratio(one, analysis.base) <= 1.0 - MATTERS]
    before, after, *left = _left(analysis, [analysis.base, free, *named])
    if not after > before > min(left, default=before):
        return ""
    [name] = free.beyond(analysis.base)
    known = analysis.search.unknowns[name]
    law = f"a {known.quantity} that depends on {known.signal.replace('_', ' ')}"
    least = int(np.argmin(left))
    return (
        f"in windows of {_window(analysis)} {law} predicts best, but of the error of whole tests, simulated "
        f"from their first sample on, it leaves {100.0 * after / before:.0f} %, {named[least].beyond(analysis.base)[0]} "
        f"{100.0 * left[least] / before:.0f} %{TOO_SHORT}"
    )


def not_in_windows(analysis: Analysis, first: Step, free: Scored | None = None) -> str:
    """Return in words that an effect takes most of the error of whole short tests, where windows show none; else nothing.

    Nothing, too, where a ``free`` law that windows show takes as much there.
    """
    named = list(first.named)
    before, law, *left = _left(analysis, [analysis.base, free or analysis.base, *named])
    if not min(left, default=before) < min((1.0 - MOST_OF_IT) * before, law):
        return ""
    least = int(np.argmin(left))
    return (
        f"windows of {_window(analysis)} show no effect, but {named[least].beyond(analysis.base)[0]} takes "
        f"{100.0 * (1.0 - left[least] / before):.0f} % of the error of whole tests, simulated from their first sample on{TOO_SHORT}"
    )


def names_not_borne_out(analysis: Analysis, model: Scored, names: Sequence[str]) -> str:
    """Return in words that whole short tests contradict names that windows show; empty where they do not.

    So it is where most of what a model errs by with the names it does not err by without them, unless tests were repeated.
    """
    if analysis.measured.repeated:
        return ""
    before, after = _left(analysis, [analysis.base, model])
    if not before < MOST_OF_IT * after:
        return ""
    grown = f"{after / before:.1f} times as large as without" if np.isfinite(after) else "without end"
    return (
        f"in windows of {_window(analysis)} {' with '.join(names)} predicts best, but the error of whole tests, simulated from their "
        f"first sample on, is {grown} with it{TOO_SHORT}"
    )


def _left(analysis: Analysis, models: Sequence[Scored]) -> list[float]:
    """Return the error (rms, in units of the sensors' noise) of each model over whole short tests; 0 where these are not looked at.

    A foreign loop hides in whole tests what acts slowly.
    """
    layout = analysis.windows.layout
    if layout.memory or not layout.short or layout.measured.plant.loop == "foreign":
        return [0.0] * len(models)
    found = []
    for model in models:
        windows = replace(analysis.windows)
        windows.place = model.place
        own = through(windows)
        own.move_starts(model.fitted.candidate)
        errors = own.errors(model.fitted.candidate) / layout.measured.noise
        found.append(float(np.sqrt(np.mean(np.nan_to_num(errors, nan=np.inf) ** 2))))
    return found


def _window(analysis: Analysis) -> str:
    return f"{plain(analysis.windows.layout.width * analysis.measured.period, 2)} s"
