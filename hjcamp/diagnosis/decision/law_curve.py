"""What a named effect says over the driver of an unknown: as much of the unknown's quantity as would do the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.calibration.analysis import Analysis
from hjcamp.diagnosis.candidates.nonparametric_terms import Unknown
from hjcamp.diagnosis.residuals.simulated import ZERO
from hjcamp.diagnosis.selection.scored import Scored
from hjcamp.model.checks.place_checks import PlainModel
from hjcamp.model.declare.base_values import DELAY
from hjcamp.model.declare.candidate import Candidate
from hjcamp.model.declare.effect import Effect
from hjcamp.model.language.vocabulary import read_vocabulary

Array = NDArray[np.float64]
LOOKED_AT = 240
BINS = 14
FEWEST = 2


@dataclass(frozen=True)
class LawCurve:
    """Mean amounts (bins,) over mean places of a driver (bins,) for one sign of motion (0: none is known), SI; NaN not seen."""

    sign: float
    x: Array
    y: Array


def law_curves(analysis: Analysis, model: Scored, unknown: Unknown, beside: Candidate) -> list[LawCurve]:
    r"""Return what the effects of a model beyond the base say over the driver of an unknown, each direction of motion on its own.

    At moments of the tests the amount of the unknown's quantity is looked for that changes the rates (a sensor's reading) of
    the plant as the effects do, with the base as it is with them instead of as it is ``beside`` the unknown:
    :math:`a = \Delta_e \cdot \Delta_u / \Delta_u \cdot \Delta_u`. Empty where an effect has a memory, so that it has no value
    at a moment, or acts elsewhere.
    """
    effects = [analysis.search.library[name] for name in model.beyond(analysis.base)]
    if not effects or any(effect.states for effect in effects):
        return []
    driver, amount, sign = _moments(analysis, model, effects, unknown, beside)
    inside = np.isfinite(driver) & np.isfinite(amount)
    if not inside.any() or not np.any(amount[inside] != 0.0):
        return []
    edges = np.linspace(unknown.low, unknown.high, BINS + 1)
    found = []
    for way in np.unique(sign[inside])[::-1]:
        if way == 0.0 and len(np.unique(sign[inside])) > 1:
            continue  # what rests between moves
        place = np.digitize(driver, edges) - 1
        members = [inside & (sign == way) & (place == k) for k in range(BINS)]
        # the middle of what was seen, not of the bin: a law that rises would else look bent
        places, means = (
            np.array([float(np.mean(values[one])) if one.sum() >= FEWEST else np.nan for one in members])
            for values in (driver, amount)
        )
        found.append(LawCurve(float(way), places, means))
    return found


def _moments(
    analysis: Analysis, model: Scored, effects: Sequence[type[Effect]], unknown: Unknown, beside: Candidate
) -> tuple[Array, Array, Array]:
    """Return driver, amount and sign of motion at some moments of the tests."""
    layout, plant = analysis.windows.layout, analysis.measured.plant
    candidate = model.fitted.candidate
    passed = analysis.windows.readings(candidate)[1]
    before, base = _parameters(beside), _parameters(candidate)
    own = {f"{effect.name}.{name}": value for effect in effects for name, value in candidate.effects[effect.name].items()}
    bare = unknown.effect.name
    flat = {f"{bare}.{name}": end for name, end in unknown.ends.items()}
    flat |= {f"{bare}.{name}": unknown.usual for name in unknown.amplitudes}
    ports = read_vocabulary(plant).ports.values()
    moving = next((port.names["velocity"] for port in ports if port.names.get("velocity") in plant.states), "")
    inputs = [name for name in plant.inputs if name not in ("time", "direction")]
    found: list[tuple[float, float, float]] = []
    for given, windows in layout.groups:
        rows = np.flatnonzero(np.repeat(windows, layout.width) & np.isfinite(passed).all(axis=1))
        some = np.unique(np.linspace(0, max(len(rows) - 1, 0), LOOKED_AT // len(layout.groups) + 2).astype(int))
        rows = rows[some[some < len(rows)]]
        models = [
            PlainModel(plant, (), {**before, **given}),
            PlainModel(plant, tuple(effects), {**base, **given, **own}),
            PlainModel(plant, (unknown.effect,), {**before, **given, **flat}),
        ]
        for row in rows:
            place = {name: float(passed[row, k]) for k, name in enumerate(plant.states)}
            place |= {name: float(layout.inputs[row, k]) for k, name in enumerate(inputs)}
            place["time"] = float(layout.time[row])
            for port in ports:
                if port.kind == "contact":
                    place[port.names["direction"]] = float(np.sign(place.get(port.names["velocity"], 0.0)))
            found.append(_moment(models, place, unknown, float(np.sign(place.get(moving, 0.0)))))
    return tuple(np.array(column) for column in zip(*found, strict=True)) if found else (np.zeros(0),) * 3  # type: ignore[return-value]


def _parameters(candidate: Candidate) -> dict[str, float]:
    return {name: value for name, value in candidate.base.items() if not name.startswith((DELAY, ZERO))}


def _moment(
    models: Sequence[PlainModel], place: Mapping[str, float], unknown: Unknown, sign: float
) -> tuple[float, float, float]:
    """Return driver, amount and sign of motion at one moment; NaN where it cannot be computed."""
    try:
        with np.errstate(all="ignore"):
            signals = models[0].signals(place)
            seen = [_answers(one, place, unknown) for one in models]
    except (ArithmeticError, ValueError):
        return np.nan, np.nan, sign
    theirs, ours = seen[1] - seen[0], seen[2] - seen[0]
    square = float(ours @ ours)
    amount = unknown.amount(unknown.usual) * float(theirs @ ours) / square if square > 0.0 else np.nan
    first, *less = (float(signals.get(name, place.get(name, np.nan))) for name in unknown.signal.split(" - "))
    return unknown.over(first - sum(less)), amount, sign


def _answers(model: PlainModel, place: Mapping[str, float], unknown: Unknown) -> Array:
    """Return what an unknown changes: its slots where it acts on a sensor or on what a store takes, else the rates over usual sizes."""
    stored = getattr(unknown.effect, "positive", False) and unknown.quantity != "value"
    if unknown.quantity == "reading" or stored:
        signals = model.signals(place)
        return np.array([signals[slot] for slot in unknown.effect.terms])
    rates = model.rates(place)
    return np.array([rates[name] / abs(item.typical) for name, item in model.plant.states.items()])
