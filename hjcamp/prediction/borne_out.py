"""Whether short tests, simulated from their first sample on, bear out what their windows show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hjcamp.prediction.analysis import Analysis
from hjcamp.prediction.levels import MATTERS
from hjcamp.prediction.scored import Scored
from hjcamp.prediction.selection import Step


def not_borne_out(analysis: Analysis, first: Step, free: Scored) -> str:
    """Return in words that whole short tests contradict a free law that windows show; empty where they do not.

    So it is where the law leaves more than the base does there, and a name that takes what matters in windows leaves less. A foreign
    loop hides in whole tests what acts slowly.
    """
    search, base, windows = analysis.search, analysis.base, analysis.windows
    layout = windows.layout
    if layout.memory or not layout.short or layout.measured.plant.loop == "foreign":
        return ""
    own = replace(windows, layout=replace(layout, memory=len(layout.readings)))
    kept = windows.place

    def left(model: Scored) -> float:
        windows.place = model.place
        own.starts = windows.starts.copy()
        own.move_starts(model.fitted.candidate)
        return float(np.sqrt(np.mean((own.errors(model.fitted.candidate) / layout.measured.noise) ** 2)))

    before, law = left(base), left(free)
    names = {one.beyond(base)[0]: left(one) for one in first.named if search.error_ratio(one, base) <= 1.0 - MATTERS}
    windows.place = kept
    name = min(names, key=lambda one: names[one], default="")
    if not name or not law > before > names[name]:
        return ""
    [law_name] = free.beyond(base)
    return (
        f"in windows of {layout.width * layout.measured.period:.2g} s {law_name.replace('_', ' ')} predicts best, but simulated from "
        f"the first sample on it leaves {100.0 * law / before:.0f} % of the error, {name} {100.0 * names[name] / before:.0f} %: these "
        "windows are too short for what acts slowly; longer tests, or repeated ones"
    )
