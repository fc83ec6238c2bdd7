"""Which share of an error a model leaves: of the whole, and of what lies above repeatability."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.diagnosis.data.repeatability import in_units, unknown_repeatability
from hjcamp.diagnosis.levels import MATTERS

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.selection.scored import Scored


def rms_ratio(analysis: Analysis, model: Scored, before: Scored) -> float:
    """Return what a model leaves of another's whole rms on held-out blocks, in the sensor in which it takes most."""
    squares = [analysis.search.squares(one.features) for one in (model, before)]
    return float(np.min(unknown_repeatability(len(squares[0])).left(*squares)))


def left_above(analysis: Analysis, model: Scored, before: Scored) -> float | None:
    """Return what a model leaves of another's rms above the noise floor on held-out blocks, in the sensor in which it takes most.

    None where the other lies above the noise floor by no more than is known of that.
    """
    layout, search = analysis.windows.layout, analysis.search
    least = (analysis.noise_floor.of_sensors(layout) / in_units(np.ones(analysis.noise_floor.moments.shape[0]), layout)) ** 2
    known = search.repeatability
    unsure = known.unsure if known and analysis.noise_floor.source == "repetitions" else MATTERS * least
    after, whole = (search.squares(one.features) - least for one in (model, before))
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
