"""How far a simulated test leaves what the measured tests visited."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.design.truth import Bench
from hjcamp.diagnosis.residuals.windows import Windows

Array = NDArray[np.float64]
# A state or input is where it is for all but this share of the time, in percent.
TAIL = 0.5


@dataclass(frozen=True)
class Beyond:
    """A state or input that a test takes beyond its measured range ``low`` to ``high``: to ``reached``, by ``share`` of it (SI)."""

    name: str
    unit: str
    low: float
    high: float
    reached: float
    share: float


def ranges(analysis: Analysis) -> tuple[Array, Array]:
    """Return the least and greatest of every state and input (states and inputs,) along the measured tests."""
    layout = analysis.windows.layout
    states = analysis.windows.readings(analysis.base.fitted.candidate)[1]
    whole = np.column_stack([states, layout.inputs])
    return np.nanmin(whole, axis=0), np.nanmax(whole, axis=0)


def beyond(analysis: Analysis, bench: Bench, truths: Sequence[Windows], known: tuple[Array, Array]) -> list[list[Beyond]]:
    """Return for each test of a bench what it takes beyond the known ranges with any of the true rivals."""
    plant, layout = analysis.measured.plant, bench.windows.layout
    units = {name: item.unit for name, item in plant.states.items()}
    units |= {name: item.unit for name, item in plant.inputs.items() if name not in ("time", "direction")}
    low, high = known
    span = np.maximum(high - low, 1e-300)
    of_row = np.repeat(layout.of_test, layout.width)
    wholes = [_states_and_inputs(one) for one in truths]
    found: list[list[Beyond]] = []
    for test in range(len(layout.counts)):
        rows = of_row == test
        each: dict[str, Beyond] = {}
        for whole in wholes:
            values = whole[rows]
            for k, (name, unit) in enumerate(units.items()):
                if high[k] <= low[k] and np.ptp(values[:, k]) == 0.0:
                    continue
                bottom, top = (
                    np.percentile(values[:, k], (TAIL, 100.0 - TAIL)) if np.all(np.isfinite(values[:, k])) else (np.nan, np.inf)
                )
                share, reached = max(((low[k] - bottom) / span[k], bottom), ((top - high[k]) / span[k], top))
                if not share <= max(each[name].share if name in each else 0.0, 0.01):
                    each[name] = Beyond(name, unit, float(low[k]), float(high[k]), float(reached), float(share))
        found.append(sorted(each.values(), key=lambda one: -one.share))
    return found


def _states_and_inputs(windows: Windows) -> Array:
    """Return the states at the begin of each window, held over it, and the inputs (n, states and inputs)."""
    layout = windows.layout
    return np.column_stack([np.repeat(windows.starts, layout.width, axis=0), layout.inputs])
