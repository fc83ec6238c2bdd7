"""Which share of an error a model leaves: of the whole, and of what lies above repeatability."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.data.repeatability import in_units
from hjcamp.diagnosis.estimation.likelihood import size
from hjcamp.diagnosis.levels import DELTA

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.selection.scored import Scored

Array = NDArray[np.float64]


def held_out(analysis: Analysis, model: Scored) -> float:
    """Return the size of what a model's predictions over windows leave of blocks left out (`likelihood.size`)."""
    return size(analysis.windows.layout.predictions(model.features))


def squares_of(analysis: Analysis, features: Array) -> Array:
    """Return the mean squares (sensors,) of the predictions among features (windows, d), in units of the sensors' noise."""
    return analysis.channels.of(np.mean(features**2, axis=0))[: len(analysis.measured.sensors)]


def rms_ratio(analysis: Analysis, model: Scored, before: Scored) -> float:
    """Return what a model leaves of another's whole rms on held-out blocks, in the sensor in which it explains most."""
    after, whole = (squares_of(analysis, one.features) + 1.0 for one in (model, before))
    return float(np.min(np.sqrt(after / whole)))


def left_above(analysis: Analysis, model: Scored, before: Scored) -> float | None:
    """Return what a model leaves of another's rms above the noise floor on held-out blocks, in the sensor in which it explains most.

    None where the other lies above the noise floor by no more than is known of that.
    """
    layout = analysis.windows.layout
    least = (analysis.noise_floor.of_sensors(layout) / in_units(np.ones(analysis.noise_floor.moments.shape[0]), layout)) ** 2
    known = analysis.channels.repeatability.unsure[: len(least)]
    unsure = known if analysis.noise_floor.source == "repetitions" else DELTA * least
    after, whole = (squares_of(analysis, one.features) - least for one in (model, before))
    shares = np.sqrt(np.maximum(after, 0.0) / np.maximum(whole, 1e-300))[whole > unsure]
    return float(shares.min()) if len(shares) else None


def left_of(row: Mapping[str, Any]) -> float:
    """Return the share that a row of an answer leaves above the noise floor; of the whole rms where nothing lies above that."""
    above = row.get("left_above_repeatability")
    return float(row["heldout_error_ratio" if "heldout_error_ratio" in row else "left"] if above is None else above)


def share_of(row: Mapping[str, Any], source: str) -> str:
    """Return in words of what `left_of` a row is a share, by where the noise floor comes from."""
    if row.get("left_above_repeatability") is None:
        return "the error"
    return "the error above the sensor's noise" if source == "sensor" else "the error above repeatability"
