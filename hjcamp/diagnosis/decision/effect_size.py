"""How large an effect is at the tests' own operating point: what it changes of the channel that it changes most."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.data.repeatability import in_units
from hjcamp.diagnosis.screening.settings import amplitudes_of, far_off
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.declare.effect import Effect


def functional(analysis: Analysis, name: str, model: Scored, parameters: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the rms by which an effect changes the channel that it changes most over its floor, in the unit of the channel's field.

    Whatever its law, it compares with that of another one. What a wrong start of a window explains is no change. The 95 % interval is
    in proportion to that of the amplitude among ``parameters`` (name: value, ci95).
    """
    windows, layout = analysis.windows, analysis.windows.layout
    kept, windows.place = windows.place, model.place
    change = windows.features(model.fitted.candidate.without({name})) - model.fitted.features
    windows.place = kept
    rms = in_units(np.nan_to_num(np.mean(change**2, axis=0)), layout)
    most = int(np.argmax(rms / np.maximum(analysis.noise_floor.of_sensors(layout), 1e-300)))
    sensor = layout.measured.sensors[most]
    value = float(rms[most] * sensor.scale)
    return {
        "name": f"change of {sensor.quantity.replace('_', ' ')}",
        "value": value,
        "unit": sensor.unit,
        "ci95": in_proportion(analysis.search.library[name], parameters, value),
    }


def in_proportion(effect: type[Effect], parameters: Mapping[str, Mapping[str, Any]], value: float) -> list[float] | None:
    """Return the interval of a size that is in proportion to the amplitude of an effect; None where that is not known."""
    amplitude = next((one for one in amplitudes_of(effect) if one in parameters), None)
    row = parameters[amplitude] if amplitude is not None else {}
    if amplitude is None or row.get("ci95") is None or not row.get("told", True):
        return None
    item = effect.parameters[amplitude]
    off = item.off or 0.0
    size = row["value"] - off
    if size == 0.0 or far_off(item):
        return None
    ends = sorted((end - off) / size * value for end in row["ci95"])
    return [max(ends[0], 0.0), max(ends[1], 0.0)]
