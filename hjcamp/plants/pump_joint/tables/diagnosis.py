"""The diagnosis of a table: verdict, what moved, and the error on cells that were and were not used."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hjcamp.plants.pump_joint.tables.cells import SIMULATED, Cells, robust
from hjcamp.plants.pump_joint.tables.fit import Fit
from hjcamp.plants.pump_joint.tables.ledger import Ledger
from hjcamp.plants.pump_joint.tables.question import Question
from hjcamp.plants.pump_joint.tables.rig import Rig, gated
from hjcamp.plants.pump_joint.tables.search import EFFORTS, LEVEL, Search, Step, penalised
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
NOTHING, EFFECT, ONE_OF, OUTSIDE, CANNOT_TELL = "nothing_missing", "effect", "one_of", "outside_library", "cannot_tell"
#: A rival whose weight beside the best (Akaike's) is above this is not told apart from it.
LEAST_WEIGHT = 0.05


@dataclass(frozen=True)
class Judged:
    """One model on one set of cells: its simulated means (cells,), their errors in sigma, loss and log ratio."""

    cells: Cells
    simulated: Array

    @property
    def errors(self) -> Array:
        """(simulated - measured) / sigma."""
        return self.cells.errors(self.simulated)

    @property
    def loss(self) -> float:
        """The robust loss."""
        return float(robust(self.errors).sum())

    @property
    def near(self) -> int:
        """How many cells are within two sigma."""
        return int(np.sum(np.abs(self.errors) <= 2.0))

    def log_ratio(self, table: str | None = None) -> float:
        """Return the mean absolute log ratio over RMSE and largest error of one table, or all."""
        inside = self.cells.of_table(table) if table else np.ones(len(self.cells), dtype=bool)
        known = inside & self.cells.logarithmic
        if not known.any():
            return math.nan
        ratio = np.maximum(np.abs(self.simulated[known]), 1e-3) / np.abs(self.cells.means[known])
        return float(np.mean(np.abs(np.log(ratio))))


@dataclass(frozen=True)
class Diagnosis:
    """The answer: ``models`` by name (published, base, and the accepted one where it has more), their cells, the verdict."""

    question: Question
    held_out: Question | None
    verdict: str
    effects: tuple[str, ...]
    p_value: float
    p_left: float
    lacking: tuple[str, ...]
    models: Mapping[str, Fit]
    fitted: Mapping[str, Judged]
    predicted: Mapping[str, Judged]
    steps: Sequence[Step]

    @property
    def accepted(self) -> Fit:
        """The model behind the verdict."""
        return list(self.models.values())[-1]


def diagnose(
    question: Question,
    others: Question | None,
    library: Sequence[str],
    effort: str,
    seed: int,
    crew: Crew,
    folder: Path | None,
    report: Callable[[str, float], None],
) -> Diagnosis:
    """Return the diagnosis of a table; finished fits are kept in ``folder`` and read from there.

    ``library`` names what may be missing; effects that some test has anyway, such as its payload, are left out.
    """
    published = Fit((), {}, math.nan)
    if question.lacking:
        return Diagnosis(
            question, others, CANNOT_TELL, (), 1.0, 1.0, tuple(question.lacking), {"published": published}, {}, {}, ()
        )
    report("preparing the tests", 0.0)
    rig = Rig.planned(question.conditions, SIMULATED, seed, lambda at: report("preparing the tests", 0.02 * at))
    other = Rig.planned(others.conditions, SIMULATED, seed) if others else None
    known = rig.known | (other.known if other else frozenset())
    names = [name for name in library if name not in known]
    laws = sorted({gated(place.law).source for tests in rig.tests for place in tests})
    ledger = Ledger(folder / "fits.json" if folder else None, _asked(question, laws, names, seed))
    search = Search(rig, question.cells, names, EFFORTS[effort], seed, crew, ledger, report)
    model, steps, elsewhere = search.run()
    report("judging", 0.92)
    models = {"published": published, "base": steps[0].before if steps else model}
    if model.names:
        models["accepted"] = model
    else:
        models["base"] = model
    fitted = judged(question, rig, models)
    predicted = judged(others, other, models) if others and other else {}
    p_left = _p_left(search, model, list(fitted.values())[-1].loss)
    word, effects = verdict_of(model, steps, p_left, elsewhere)
    p_value = steps[0].p_value if steps else 1.0
    return Diagnosis(question, others, word, effects, p_value, p_left, (), models, fitted, predicted, steps)


def judged(question: Question, rig: Rig, models: Mapping[str, Fit]) -> dict[str, Judged]:
    """Return each model's means of the cells."""
    return {
        name: Judged(question.cells, question.cells.of(rig.indicators(model.settings if model.places else {})))
        for name, model in models.items()
    }


def _asked(question: Question, laws: Sequence[str], names: Sequence[str], seed: int) -> str:
    """Return the hash of all that decides the result of a fit, but for its budget."""
    return hashlib.sha256(repr((question.sha256, laws, list(names), seed)).encode()).hexdigest()


def _p_left(search: Search, model: Fit, loss: float) -> float:
    """Return the share of the model's own tables that it meets no better than the measured one."""
    own = search.losses_of_replicates(model)
    return (1 + sum(one >= loss for one in own)) / (1 + len(own))


def verdict_of(model: Fit, steps: Sequence[Step], p_left: float, elsewhere: Sequence[Fit] = ()) -> tuple[str, tuple[str, ...]]:
    """Return one of the five words, and the names that go with it; ``elsewhere`` are the models of other bottoms of the base."""
    if not model.names:
        return (NOTHING if p_left > LEVEL else OUTSIDE), ()
    last = next(one for one in steps if any(rival.names == model.names for rival in one.rivals))
    best = min(penalised(one, last.control) for one in last.rivals)
    similar = [one for one in last.rivals if math.exp(0.5 * (best - penalised(one, last.control))) > LEAST_WEIGHT]
    # models of other bottoms share no step: each pays for all that it has
    base = steps[0].before
    whole = penalised(model, base)
    others = [one for one in elsewhere if one.names and one.names != model.names]
    similar += [one for one in others if math.exp(0.5 * (whole - penalised(one, base))) > LEAST_WEIGHT]
    if p_left <= LEVEL:
        return OUTSIDE, model.names
    if len(similar) > 1:
        return ONE_OF, tuple(dict.fromkeys(name for one in similar for name in one.names))
    return EFFECT, model.names
