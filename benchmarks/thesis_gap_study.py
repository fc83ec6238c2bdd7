"""The fitted tables in memory, and a ledger that keeps every finished fit."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from thesis_gap_cells import Cells, cells_for, robust
from thesis_gap_rig import OPENINGS, Rig, gated_simulator, planned
from thesis_gap_search import Fit, Quantity, Task, base_quantities, candidate_quantities, fit, surprise

from hjcamp.effects import load_effects
from hjcamp.storage import write_whole

Array = NDArray[np.float64]
FITTED = ("5.4.1", "5.4.2")
SEED = 1
WIDTH = 0.15


class Ledger:
    """Results by name in one JSON file, written whole after each of them; those of other ``equations`` do not count."""

    def __init__(self, path: Path, equations: str = "") -> None:
        self.path = path
        self.found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        if self.found and self.found.get("equations") != equations:
            print(f"{path}: made with other equations; everything is computed anew", flush=True)
            self.found = {}
        self.found["equations"] = equations

    def keep(self, name: str, compute: Callable[[], Any]) -> Any:
        """Return what is known under ``name``, else compute and keep it."""
        if name not in self.found:
            self.found[name] = compute()
            write_whole(self.path, json.dumps(self.found, indent=1))
            print(name, flush=True)
        return self.found[name]


def fingerprint() -> str:
    """Return a hash of the model's equations and defaults and of the openings."""
    parameters = gated_simulator().composition.parameters
    return hashlib.sha256(f"{gated_simulator().source}{parameters}{OPENINGS}".encode()).hexdigest()


def candidates() -> list[str]:
    """Return every effect of the library and every opening of the text."""
    return [*sorted(load_effects([])), *OPENINGS]


def quantities_of(names: Sequence[str]) -> list[Quantity]:
    """Return the base quantities and those of the named candidates."""
    return base_quantities() + [quantity for name in names for quantity in candidate_quantities(name)]


@dataclass(frozen=True)
class Study:
    """The fitted tables with one, three and seven repetitions, and what is already known."""

    ledger: Ledger
    cells: Cells
    one: Rig
    three: Rig
    seven: Rig

    @classmethod
    def begin(cls, path: Path) -> Study:
        """Prepare every test of Tables 5.4.1 and 5.4.2."""
        seven = Rig(planned("controllers", 7, SEED))
        one, three = (Rig([place for place in seven.places if place.repetition <= count]) for count in (1, 3))
        return cls(Ledger(path, fingerprint()), cells_for(seven.conditions, FITTED), one, three, seven)

    @property
    def task(self) -> Task:
        """The fit to all cells with one repetition."""
        return Task(self.one, self.cells)

    def fitted(
        self,
        name: str,
        names: Sequence[str],
        start: dict[str, float],
        budget: int,
        task: Task | None = None,
        seed: int = SEED,
    ) -> dict[str, Any]:
        """Return the kept fit of the base and ``names`` from the places of ``start``; new ones start as published."""
        asked = task or self.task

        def compute() -> dict[str, Any]:
            quantities = quantities_of(names)
            places = np.array([start.get(one.name, one.start) for one in quantities])
            found = fit(asked, quantities, places, WIDTH, budget, seed)
            return record(found, names)

        return dict(self.ledger.keep(name, compute))

    def measured(self, name: str, names: Sequence[str], places: dict[str, float]) -> dict[str, Any]:
        """Return the kept table of a fit with seven repetitions: means and loss of the cells."""

        def compute() -> dict[str, Any]:
            settings = settings_from(names, places) if places else {}
            means = self.cells.of(self.seven.indicators(settings))
            errors = self.cells.errors(means)
            return {"means": means.round(4).tolist(), "loss": float(robust(errors).sum())}

        return dict(self.ledger.keep(name, compute))


def record(found: Fit, names: Sequence[str]) -> dict[str, Any]:
    """Return a fit as plain values."""
    places = {one.name: float(place) for one, place in zip(found.quantities, found.places, strict=True)}
    values = {one.name: one.back(places[one.name]) for one in found.quantities}
    paid = surprise(found.quantities, found.places)
    return {"names": list(names), "places": places, "values": values, "loss": found.loss, "surprise": paid}


def settings_from(names: Sequence[str], places: dict[str, float]) -> dict[str, float]:
    """Return the settings of the rig for kept places."""
    quantities = quantities_of(names)
    return Fit(quantities, np.array([places[one.name] for one in quantities]), 0.0).settings


def penalised(trial: dict[str, Any]) -> float:
    """Return the loss plus 2 for each fitted quantity beyond the base."""
    return float(trial["loss"]) + 2.0 * (len(trial["places"]) - len(base_quantities()))
