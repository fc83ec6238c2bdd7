"""The forward search: base, then one candidate at a time while surrogate tables do not promise as much by chance."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hjcamp.plants.pump_joint.tables.cells import Cells, robust
from hjcamp.plants.pump_joint.tables.fit import Fit, fit
from hjcamp.plants.pump_joint.tables.ledger import Ledger
from hjcamp.plants.pump_joint.tables.probes import COST, Promise, look
from hjcamp.plants.pump_joint.tables.quantities import base_quantities, candidate_quantities
from hjcamp.plants.pump_joint.tables.rig import Rig
from hjcamp.workers.pool import Crew

#: Chance of a gain as large on a table in which nothing is missing, from which on it is no reason to add anything.
LEVEL = 0.05
#: Candidates are refitted whose predicted loss is within this of the best: Akaike's weight of the last is then a twentieth.
RIVALS = 6.0
#: The tail of the twins' gains is the largest tenth of them, and ten of few.
TENTH, FEWEST = 10, 10
#: Candidates of a step that the answer names.
SHOWN = 5


@dataclass(frozen=True)
class Effort:
    """How long is searched: tables of the base's fits, of others, of the evolution of what is taken; rivals, twins, steps."""

    base: int
    short: int
    polish: int
    refitted: int
    twins: int
    steps: int


EFFORTS = {
    "quick": Effort(base=120, short=60, polish=200, refitted=3, twins=199, steps=4),
    "standard": Effort(base=250, short=120, polish=1000, refitted=6, twins=199, steps=5),
    "thorough": Effort(base=400, short=250, polish=3000, refitted=10, twins=999, steps=6),
}


@dataclass(frozen=True)
class Step:
    """One step: the model before, the control (refitted alike), its rivals with a candidate each, the twins' gains.

    ``promised`` is what the linear prediction says of the best candidates, and ``predicted`` the gain of the first, by
    which alone the twins are judged. Where that much is chance nothing is refitted: there are no rivals. ``form`` is the
    share of the allowed error of form by which gains are judged.
    """

    before: Fit
    control: Fit
    rivals: Sequence[Fit]
    twins: Sequence[float]
    predicted: float = math.inf
    promised: Sequence[Promise] = ()
    form: float = 1.0

    @property
    def gain(self) -> float:
        """The fall of the loss by the best rival, less the cost of its quantities; as predicted where none was refitted."""
        return max((self.control.loss - penalised(one, self.control) for one in self.rivals), default=self.predicted)

    @property
    def p_value(self) -> float:
        """The chance of such a gain, as fitted or as predicted, whichever is less. Without twins the gain is not tested."""
        if len(self.twins) < 2:
            return 1.0
        return chance(min(self.gain, self.predicted), self.twins)


def chance(gain: float, twins: Sequence[float]) -> float:
    r"""Return how often nothing gains so much: counted among twins, beyond all of them along their own tail.

    .. math:: p = \frac{1 + \#\{g_i \ge g\}}{1 + n}\,e^{-\max(g - g_{(1)}, 0) / \beta}, \quad
              \beta = \frac{1}{k} \sum_{i \le k} (g_{(i)} - g_{(k)})

    with the k largest of n gains, a tenth of them (ten where that is less). No tail is taken to be less wide than half a
    unit of loss. Source: Knijnenburg et al. (2009), Bioinformatics 25(12), i161-i168, doi:10.1093/bioinformatics/btp211.
    """
    ordered = np.sort(np.asarray(twins, dtype=float))[::-1]
    number = len(ordered)
    most = max(number // TENTH, min(FEWEST, number - 1))
    width = max(float(np.mean(ordered[:most] - ordered[most - 1])), 0.5)
    counted = (1 + np.sum(ordered >= gain)) / (1 + number)
    return float(counted * math.exp(-max(gain - float(ordered[0]), 0.0) / width))


def penalised(rival: Fit, control: Fit) -> float:
    """Return the loss of a rival with the cost of the quantities that it has more than the control, or free of a tolerance."""
    more = [name for name in rival.names if name not in control.names]
    return rival.loss + COST * sum(len(candidate_quantities(name)) for name in more)


@dataclass(frozen=True)
class Search:
    """What is searched, with what, and what is known of it already."""

    rig: Rig
    cells: Cells
    names: Sequence[str]
    effort: Effort
    seed: int
    crew: Crew
    ledger: Ledger
    report: Callable[[str, float], None]

    def base(self) -> Fit:
        """Return the base fitted from the published constants, and from them without a drop of friction; the better.

        The second start is left out where the first already meets the table as tables of its own would.
        """
        self.report("fitting the base", 0.02)
        printed = self._fit("base as printed", (), [{}], self.effort.base)
        if printed.loss <= len(self.cells):
            return printed
        level = {one.name: one.forth(1.0) for one in base_quantities() if one.name.startswith("drop_")}
        other = self._fit("base without a drop of friction", (), [level], self.effort.base)
        return min(printed, other, key=lambda one: one.loss)

    def step(self, number: int, model: Fit) -> Step:
        """Return the candidates that promise most beside the control, and what the twins of ``model`` promise by chance."""
        begin, share = 0.1 + 0.8 * number / self.effort.steps, 0.8 / self.effort.steps
        names = [name for name in self.names if name not in model.names]
        doing = f"step {number + 1}: looking at {len(names)} candidates"
        looked = look(
            self.rig, self.cells, model, names, self.crew, lambda at: self.report(doing, begin + 0.4 * share * at)
        )
        promise = looked.predicted(self.cells)
        generator = np.random.default_rng([self.seed, number])
        twins = [looked.predicted(self.cells.drawn(looked.simulated, generator)).gain for _ in range(self.effort.twins)]
        found = Step(model, model, (), twins, promise.gain, promise.candidates[:SHOWN], self.cells.form)
        if found.p_value > LEVEL:
            return found
        self.report(f"step {number + 1}: fitting what promises most", begin + 0.4 * share)
        near = [one for one in promise.candidates if one.loss <= promise.candidates[0].loss + RIVALS]
        control, *rivals = self.crew.together(
            lambda one: self._refitted(f"step {number}", model, one), [promise.alone, *near[: self.effort.refitted]]
        )
        return replace(found, control=control, rivals=rivals)

    def _refitted(self, key: str, model: Fit, promise: Promise) -> Fit:
        """Refit the model with what a promise adds, from where the model or where the promise is; all alike."""
        names = (*model.names, *([promise.name] if promise.name else []))
        starts = [{**promise.places, **model.places}, promise.places]
        return self._fit(f"{key} {promise.name or 'control'}", names, starts, self.effort.short)

    def longer(self, key: str, model: Fit) -> Fit:
        """Return an accepted model searched for longer."""
        starts: list[Mapping[str, float]] = [model.places]
        return self._fit(f"{key} for longer", model.names, starts, self.effort.short, self.effort.polish)

    def run(self) -> tuple[Fit, list[Step]]:
        """Return the accepted model and every step, the one that adds nothing as the last.

        Gains are judged by the error of form that the base leaves, where that is less than what is allowed at first.
        """
        base = self.base()
        cells = self.cells.known_by(self.cells.of(self.rig.indicators(base.settings)), len(base.places))
        return replace(self, cells=cells).forward(base)

    def forward(self, base: Fit) -> tuple[Fit, list[Step]]:
        """Return the model and the steps from a base that is fitted for longer first."""
        model, steps = self.longer("base", base), []
        for number in range(self.effort.steps):
            found = self.step(number, model)
            steps.append(found)
            if not found.rivals or found.gain <= 0.0 or found.p_value > LEVEL:
                return min(model, found.control, key=lambda one: one.loss), steps
            model = self.longer(f"step {number + 1}", min(found.rivals, key=lambda one: penalised(one, found.control)))
        return model, steps

    def losses_of_twins(self, model: Fit) -> list[float]:
        """Return the loss of a model on tables of its own: what is left where nothing is missing."""
        simulated = self.cells.of(self.rig.indicators(model.settings))
        generator = np.random.default_rng([self.seed, 99])
        return [float(robust(self.cells.drawn(simulated, generator).errors(simulated)).sum()) for _ in range(199)]

    def _fit(
        self, key: str, names: Sequence[str], starts: Sequence[Mapping[str, float]], budget: int, polish: int = 0
    ) -> Fit:
        def compute() -> dict[str, Any]:
            return fit(self.rig, self.cells, tuple(names), starts, budget, self.seed, polish).as_json()

        return Fit.from_json(self.ledger.keep(f"{key}, {budget} tables", compute))
