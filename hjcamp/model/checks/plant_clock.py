"""How fast a plant is by itself: its shortest time constant relative to a sample, and whether it grows by itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import UsageError
from hjcamp.model.checks.plant_checks import evaluate, usual_places
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.vocabulary import read_vocabulary

Array = NDArray[np.float64]
LOOKED_AT = 20
# Of a state's usual size: by how much it is moved to see what that changes.
STEP = 1e-5
# Of a sample: what is over so soon no log shows, and an error in a unit often makes.
FAR_SHORTER = 1e-2


def time_constants(plant: type[Plant]) -> str:
    """Say the shortest time constant of a plant at usual states, how it compares with a sample, and whether the plant diverges."""
    if not plant.states:
        return "no states"
    values, vectors = zip(*(np.linalg.eig(rate_slopes(plant, place)) for place in usual_places(plant)[:LOOKED_AT]), strict=True)
    names, rates = list(plant.states), np.concatenate(values).real
    parts = np.abs(np.concatenate([one.T for one in vectors]))
    fastest, growing = int(np.argmin(rates)), int(np.argmax(rates))
    said = "none decays by itself"
    if rates[fastest] < 0.0:
        shortest = -1.0 / rates[fastest]
        said = f"the shortest is {shortest:.2g} s, {shortest / plant.period:.2g} samples"
        if shortest < FAR_SHORTER * plant.period:
            name = names[int(np.argmax(parts[fastest]))]
            said += f" ({name}): far shorter than a sample; is a unit wrong, or can it be without a rate?"
    if rates[growing] * plant.period * LOOKED_AT > 1.0:
        name = names[int(np.argmax(parts[growing]))]
        said += f"; {name} diverges by itself, e-fold in {1.0 / rates[growing]:.2g} s: is a sign wrong, or does a controller hold it?"
    return said


def rate_slopes(plant: type[Plant], place: dict[str, float]) -> Array:
    """Return the derivatives (n, n) of all rates by all states at a place, each state in units of its usual size."""
    lines, sizes = read_vocabulary(plant).statements, {name: abs(state.typical) for name, state in plant.states.items()}
    found = np.empty((len(sizes), len(sizes)))
    for column, (name, size) in enumerate(sizes.items()):
        ends = [evaluate(plant, lines, {**place, f"s_{name}": place[f"s_{name}"] + sign * STEP * size}) for sign in (1.0, -1.0)]
        found[:, column] = [(ends[0][f"d_{one}"] - ends[1][f"d_{one}"]) / (2.0 * STEP * own) for one, own in sizes.items()]
    if not np.all(np.isfinite(found)):
        raise UsageError(f"plant {plant.name}: the slopes of its rates leave the finite numbers at usual states")
    return found
