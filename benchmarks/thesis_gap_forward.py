"""The forward search: base, openings of the loop, then one candidate at a time while it pays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from thesis_gap_search import Task, base_quantities, candidate_quantities
from thesis_gap_study import Study, candidates, penalised

#: The openings of the loop itself join the base: the ramps ask for both whatever friction does (page, first section).
LOOP = ("controller_scale", "feedforward_gain")
RAMP_SCALE, RAMP_FEEDFORWARD = math.log(1.35), math.log(0.81)
FAR = 0.6
#: Share of the loss that a further candidate must take away.
PAYS = 0.1
HERE, FRESH, REFINED, BASE, POLISHED = 50, 150, 400, 500, 200
REFINE_BEST = 2
SEEDS = (1, 2, 3)


def forward(study: Study) -> tuple[list[dict[str, Any]], int]:
    """Return every model that was followed to the end, and the place of the accepted one.

    They are the base, the base with the openings of the loop, its rivals with one candidate more, and the accepted one of
    these with a second candidate out of the other rivals. All are fitted further with three repetitions before they are
    judged; a candidate is accepted if it takes a tenth of the loss away.
    """
    study.measured("table published", [], {})
    printed = {quantity.name: quantity.start for quantity in base_quantities()}
    level = {**printed, **no_drop()}
    base = [
        study.fitted(f"base from {name}", [], places, BASE) for name, places in (("print", printed), ("level", level))
    ]
    models = [polished(study, 0, min(base, key=penalised))]
    starts = (("print", printed), ("ramp", fresh_start()), ("base", min(base, key=penalised)["places"]))
    opened = [study.fitted(f"opened from {name}", LOOP, places, BASE) for name, places in starts]
    best = min(opened, key=penalised)
    models.append(polished(study, 1, best))
    _, *rivals = one_step(study, 1, best)
    # A Stribeck velocity does nothing where static friction is Coulomb friction: such a rival is the model itself.
    different = [rival for rival in rivals if abs(float(rival["loss"]) - float(best["loss"])) > 0.01]
    for rival in sorted(different, key=penalised):
        models.append(polished(study, len(models), rival))
    accepted = judged(models, 1, range(2, len(models)))
    if accepted > 1:
        others = [model for place, model in enumerate(models) if place > 1 and place != accepted]
        first, second = models[accepted], len(models)
        for other in others:
            own = {name: place for name, place in other["places"].items() if name not in first["places"]}
            joined = {"names": [*first["names"], other["names"][-1]], "places": {**first["places"], **own}}
            models.append(polished(study, len(models), joined))
        accepted = judged(models, accepted, range(second, len(models)))
    return models, accepted


def judged(models: Sequence[dict[str, Any]], accepted: int, rivals: Sequence[int]) -> int:
    """Return the place of the best rival if it pays, else that of the accepted model."""
    best = min(rivals, key=lambda place: penalised(models[place]), default=accepted)
    return best if penalised(models[best]) < (1.0 - PAYS) * penalised(models[accepted]) else accepted


def polished(study: Study, number: int, model: dict[str, Any]) -> dict[str, Any]:
    """Return the model fitted further with three repetitions; keep its table with seven."""
    task = Task(study.three, study.cells)
    better = study.fitted(f"model {number}", model["names"], model["places"], POLISHED, task)
    study.measured(f"table {number}", better["names"], better["places"])
    return better


def no_drop() -> dict[str, float]:
    """Return the places at which static friction is Coulomb friction."""
    return {one.name: one.forth(1.0) for one in base_quantities() if one.name.startswith("drop_")}


def fresh_start() -> dict[str, float]:
    """Return a start that no fit has seen: printed constants, no drop of friction, the loop as the ramps ask for it."""
    start = {quantity.name: quantity.start for quantity in base_quantities()}
    return {**start, **no_drop(), "controller_scale": RAMP_SCALE, "feedforward_gain": RAMP_FEEDFORWARD}


def one_step(study: Study, step: int, model: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the control and the best candidates: all searched shortly from two starts at least, the best ones longer.

    The start ``here`` is the model as it was fitted, ``fresh`` one that it has not seen: the loss has many valleys, and a
    candidate that needs the base elsewhere would never show from the fitted one alone.
    """
    names, places = model["names"], model["places"]
    joined = {name: place for name, place in places.items() if name not in fresh_start()}
    starts: dict[str, dict[str, dict[str, Any]]] = {"here": {}, "fresh": {}}
    for name in ("control", *candidates()):
        if name in names:
            continue
        more = [] if name == "control" else [name]
        starts["here"][name] = study.fitted(f"step {step} here {name}", names + more, places, HERE)
        fresh = []
        for form, own in ({"": {}} if name == "control" else begin_at(name)).items():
            begin = {**fresh_start(), **joined, **own}
            fresh.append(study.fitted(f"step {step} fresh {name}{form}", names + more, begin, FRESH))
        starts["fresh"][name] = min(fresh, key=penalised)
    control = min((found.pop("control") for found in starts.values()), key=penalised)
    refined = [longest(study, f"step {step} refined control", names, control["places"])]
    for start, found in starts.items():
        for name in sorted(found, key=lambda key: penalised(found[key]))[:REFINE_BEST]:
            refined.append(
                longest(study, f"step {step} refined {name} from {start}", [*names, name], found[name]["places"])
            )
    return refined


def longest(study: Study, key: str, names: Sequence[str], places: dict[str, float]) -> dict[str, Any]:
    """Return the best of the long searches, which differ by their random numbers: one alone often misses the valley."""
    tries = [study.fitted(f"{key}, {seed}", names, places, REFINED, seed=seed) for seed in SEEDS]
    return dict(study.ledger.keep(key, lambda: min(tries, key=penalised)))


def begin_at(name: str) -> dict[str, dict[str, float]]:
    """Return the places at which a candidate's quantities start: its first one well above what is printed or usual.

    A law whose form is open (a quantity that is neither amplitude nor shape) starts from its usual form and from the published one.
    """
    quantities = candidate_quantities(name)
    first = {quantities[0].name: quantities[0].start + FAR}
    starts = {"": first}
    for one in quantities[1:]:
        given, low = one.parameter, one.parameter.bounds[0]
        if given.off is None and not given.shape and low == 0.0 and given.default > low:
            starts[f", {one.name} {low:g}"] = {**first, one.name: one.forth(low)}
    return starts
