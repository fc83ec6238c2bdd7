"""What the fits are worth: left-out trajectories, twins, predictions of the payload tables, candidates that act alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from thesis_gap_cells import FORM_ANGLE, FORM_SHARE, PRINTED_STEP, Cells, cells_for, robust
from thesis_gap_forward import no_drop
from thesis_gap_rig import Rig, planned
from thesis_gap_search import Fit, Quantity, Task, candidate_quantities
from thesis_gap_study import SEED, Study, candidates, quantities_of, settings_from

Array = NDArray[np.float64]
PREDICTED = ("5.5.1", "5.5.2")
FOLDED, TWINNED = 350, 30
TWINS, TWIN_RIVALS = 20, 2


def leave_out(study: Study, models: Sequence[dict[str, Any]]) -> None:
    """Fit the nested models without each trajectory, from the printed constants, and keep their error on it."""
    trajectories = list(dict.fromkeys(condition["trajectory"] for condition in study.cells.conditions))
    for trajectory in trajectories:
        inside = np.array([study.cells.label(cell)[0] != trajectory for cell in range(len(study.cells.printed))])
        task = replace(study.task, kept=inside)
        places = no_drop()
        for number, model in enumerate(models):
            budget = FOLDED
            name = f"without {trajectory} model {number}"
            found = study.fitted(name, model["names"], places, budget, task)
            places = found["places"]
            settings = settings_from(model["names"], places)

            def outside(settings: dict[str, float] = settings, inside: NDArray[np.bool_] = inside) -> list[float]:
                errors = Task(study.three, study.cells).errors(settings)
                return [float(value) for value in errors[~inside]]

            study.ledger.keep(f"{name} errors", outside)
    errors = study.cells.errors(study.cells.of(study.three.indicators({})))
    study.ledger.keep("published errors", lambda: errors.tolist())


def twins(study: Study, models: Sequence[dict[str, Any]], accepted: int) -> None:
    """Refit two models to twins of the first, in which the candidate is absent; look at the second on its own twins.

    The models are the base with the loop and the accepted one; each refit begins where the model was fitted. On twins of
    the accepted model it is not refitted, so that its loss there is rather too high.
    """
    without, other = models[1], models[accepted]
    pair = {"without": without, "with": other}
    for name, model in pair.items():
        study.fitted(f"twin real {name}", model["names"], model["places"], TWINNED)
    for number in range(TWINS):
        if f"twin {number} with" not in study.ledger.found:
            target = twin_table(study.cells, settings_from(without["names"], without["places"]), number)
            task = replace(study.task, target=target)
            for name, model in pair.items():
                study.fitted(f"twin {number} {name}", model["names"], model["places"], TWINNED, task)
        settings = settings_from(other["names"], other["places"])

        def own_loss(number: int = number, settings: dict[str, float] = settings) -> float:
            task = replace(study.task, rig=study.three, target=twin_table(study.cells, settings, number))
            return float(robust(task.errors(settings)).sum())

        study.ledger.keep(f"twin {number} of accepted", own_loss)


def twin_table(cells: Cells, settings: dict[str, float], number: int) -> Array:
    """Return the cells that the thesis would have printed if the model were true but for its error of form."""
    generator = np.random.default_rng([SEED, number])
    means = cells.of(Rig(planned("controllers", 7, 1000 + number)).indicators(settings))
    draws = generator.standard_normal(len(means))
    known = cells.logarithmic
    means = np.where(known, means * np.exp(FORM_SHARE * draws), means + FORM_ANGLE * draws)
    return np.asarray(np.where(known, np.maximum(means.round(1), PRINTED_STEP), means.round(1)))


def predict(study: Study, models: Sequence[dict[str, Any]]) -> None:
    """Keep the tables 5.5.1 and 5.5.2 as the published model and each fitted one predict them, without refit."""
    rig = Rig([place for name in ("horizontal", "vertical") for place in planned(f"robustness_{name}", 7, SEED)])
    cells = cells_for(rig.conditions, PREDICTED)
    chosen: list[tuple[str, dict[str, float]]] = [("published", {})]
    chosen += [(str(number), settings_from(model["names"], model["places"])) for number, model in enumerate(models)]
    for name, settings in chosen:

        def compute(settings: dict[str, float] = settings) -> dict[str, Any]:
            means = cells.of(rig.indicators(settings))
            return {"means": means.round(4).tolist(), "loss": float(robust(cells.errors(means)).sum())}

        study.ledger.keep(f"prediction {name}", compute)


def alike(study: Study, model: dict[str, Any]) -> None:
    """Keep the responses of the cells to each candidate beside those of the model's own quantities."""

    def compute() -> dict[str, Any]:
        task = Task(study.three, study.cells)
        quantities = quantities_of(model["names"])
        places = np.array([model["places"][one.name] for one in quantities])

        def response(more: list[Quantity], at: Array, index: int) -> list[float]:
            sides = []
            for shift in (-0.15, 0.15):
                moved = at.copy()
                moved[index] += shift
                sides.append(task.errors(Fit(more, moved, 0.0).settings))
            return [float(value) for value in (sides[1] - sides[0]) / 0.3]

        own = [response(quantities, places, index) for index in range(len(quantities))]
        other = {}
        for name in candidates():
            if name not in model["names"]:
                more = candidate_quantities(name)
                at = np.array([*places, *(one.start for one in more)])
                other[name] = response([*quantities, *more], at, len(places))
        return {"own": own, "other": other}

    study.ledger.keep("responses", compute)
