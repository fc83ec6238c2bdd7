"""The forward search: base, then one candidate at a time while surrogate tables do not promise as much by chance."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hjcamp.plants.pump_joint.tables.cells import Cells, robust
from hjcamp.plants.pump_joint.tables.fit import WIDEST, Fit, fit
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
    """How long is searched: tables of the base's fits, of others, of the evolution of what is taken; rivals, replicates, steps; starts.

    The base begins at so many ``starts``. Of more than two each is fitted for longer, as short fits end on the way, and where they
    come to several bottoms of nearly one depth each is searched from.
    """

    base: int
    short: int
    polish: int
    refitted: int
    replicates: int
    steps: int
    starts: int = 2


EFFORTS = {
    "quick": Effort(base=120, short=60, polish=200, refitted=3, replicates=199, steps=4),
    "standard": Effort(base=250, short=120, polish=1000, refitted=6, replicates=199, steps=5, starts=4),
    "thorough": Effort(base=400, short=250, polish=3000, refitted=10, replicates=999, steps=6, starts=8),
}


@dataclass(frozen=True)
class Step:
    """One step: the model before, the control (refitted in the same way), its rivals with a candidate each, the null replicates' gains.

    ``promised`` is what the linear prediction says of the best candidates, and ``predicted`` the gain of the first, by
    which alone the null replicates are judged. Where that much is chance nothing is refitted: there are no rivals. ``form`` is the
    share of the allowed error of form by which gains are judged.
    """

    before: Fit
    control: Fit
    rivals: Sequence[Fit]
    replicates: Sequence[float]
    predicted: float = math.inf
    promised: Sequence[Promise] = ()
    form: float = 1.0

    @property
    def gain(self) -> float:
        """The fall of the loss by the best rival, less the cost of its quantities; as predicted where none was refitted."""
        return max((self.control.loss - penalised(one, self.control) for one in self.rivals), default=self.predicted)

    @property
    def p_value(self) -> float:
        """The chance of such a gain, as fitted or as predicted, whichever is less. Without null replicates the gain is not tested."""
        if len(self.replicates) < 2:
            return 1.0
        return chance(min(self.gain, self.predicted), self.replicates)


def chance(gain: float, replicates: Sequence[float]) -> float:
    r"""Return how often nothing gains so much: counted among null replicates, beyond all of them along their own tail.

    .. math:: p = \frac{1 + \#\{g_i \ge g\}}{1 + n}\,e^{-\max(g - g_{(1)}, 0) / \beta}, \quad
              \beta = \frac{1}{k} \sum_{i \le k} (g_{(i)} - g_{(k)})

    with the k largest of n gains, a tenth of them (ten where that is less). No tail is taken to be less wide than half a
    unit of loss. Source: Knijnenburg et al. (2009), Bioinformatics 25(12), i161-i168, doi:10.1093/bioinformatics/btp211.
    """
    ordered = np.sort(np.asarray(replicates, dtype=float))[::-1]
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
    path: str = ""

    def bases(self) -> list[Fit]:
        """Return the bases, the lowest first: fitted from the published constants, from them without a drop of friction, and from
        draws of what is known of them.

        The other starts are left out where the first already meets the table as tables of its own would.
        """
        self.report("fitting the base", 0.02)
        printed = self._fit("base as printed", (), [{}], self.effort.base)
        if printed.loss <= len(self.cells):
            return [printed]
        quantities, generator = base_quantities(), np.random.default_rng([self.seed, 98])
        starts = {
            "without a drop of friction": {one.name: one.forth(1.0) for one in quantities if one.name.startswith("drop_")}
        }
        for number in range(1, self.effort.starts - 1):
            away = generator.standard_normal(len(quantities))
            starts[f"from draw {number}"] = {
                one.name: one.start + one.spread * far for one, far in zip(quantities, away, strict=True)
            }
        fits = self.crew.together(lambda one: self._fit(f"base {one}", (), [starts[one]], self.effort.base), list(starts))
        return sorted([printed, *fits], key=lambda one: one.loss)

    def step(self, number: int, model: Fit) -> Step:
        """Return the candidates that promise most in addition to the control, and what replicates of ``model`` promise by chance."""
        begin, share = 0.1 + 0.8 * number / self.effort.steps, 0.8 / self.effort.steps
        names = [name for name in self.names if name not in model.names]
        doing = f"step {number + 1}: looking at {len(names)} candidates"
        looked = look(self.rig, self.cells, model, names, self.crew, lambda at: self.report(doing, begin + 0.4 * share * at))
        promise = looked.predicted(self.cells)
        generator = np.random.default_rng([self.seed, number])
        replicates = [
            looked.predicted(self.cells.drawn(looked.simulated, generator)).gain for _ in range(self.effort.replicates)
        ]
        found = Step(model, model, (), replicates, promise.gain, promise.candidates[:SHOWN], self.cells.form)
        if found.p_value > LEVEL:
            return found
        self.report(f"step {number + 1}: fitting what promises most", begin + 0.4 * share)
        near = [one for one in promise.candidates if one.loss <= promise.candidates[0].loss + RIVALS]
        control, *rivals = self.crew.together(
            lambda one: self._refitted(f"step {number}", model, one), [promise.alone, *near[: self.effort.refitted]]
        )
        return replace(found, control=control, rivals=rivals)

    def _refitted(self, key: str, model: Fit, promise: Promise) -> Fit:
        """Refit the model with what a promise adds, from where the model or where the promise is; all in the same way."""
        names = (*model.names, *([promise.name] if promise.name else []))
        starts = [{**promise.places, **model.places}, promise.places]
        return self._fit(f"{key} {promise.name or 'control'}", names, starts, self.effort.short)

    def longer(self, key: str, model: Fit) -> Fit:
        """Return an accepted model searched for longer."""
        starts: list[Mapping[str, float]] = [model.places]
        return self._fit(f"{key} for longer", model.names, starts, self.effort.short, self.effort.polish)

    def run(self) -> tuple[Fit, list[Step], list[Fit]]:
        """Return the accepted model, its steps, the one that adds nothing as the last, and the models of other bottoms of the base.

        Gains are judged by the error of form that the base leaves, where that is less than what is allowed at first. Each bottom
        of the base, fitted for longer, is searched from by itself; what is met best in the end is accepted.
        """
        bases = self.bases()
        base = bases[0]
        cells = self.cells.known_by(self.cells.of(self.rig.indicators(base.settings)), len(base.places))
        paths = [replace(self, cells=cells, path=f"bottom {number}, " if number else "") for number in range(len(bases))]
        if self.effort.starts <= 2:
            paths = paths[:1]
        longer = list(self.crew.together(lambda k: paths[k].longer("base", bases[k]), range(len(paths))))
        kept = {longer.index(one): one for one in different(longer)}
        found = [paths[number].forward(one) for number, one in kept.items()]
        found.sort(key=lambda one: penalised(one[0], base))
        return *found[0], [model for model, _ in found[1:]]

    def forward(self, model: Fit) -> tuple[Fit, list[Step]]:
        """Return the model and the steps from a base."""
        steps: list[Step] = []
        for number in range(self.effort.steps):
            found = self.step(number, model)
            steps.append(found)
            if not found.rivals or found.gain <= 0.0 or found.p_value > LEVEL:
                return min(model, found.control, key=lambda one: one.loss), steps
            model = self.longer(f"step {number + 1}", min(found.rivals, key=lambda one: penalised(one, found.control)))
        return model, steps

    def losses_of_replicates(self, model: Fit) -> list[float]:
        """Return the loss of a model on tables of its own: the residual where nothing is missing."""
        simulated = self.cells.of(self.rig.indicators(model.settings))
        generator = np.random.default_rng([self.seed, 99])
        return [float(robust(self.cells.drawn(simulated, generator).errors(simulated)).sum()) for _ in range(199)]

    def _fit(self, key: str, names: Sequence[str], starts: Sequence[Mapping[str, float]], budget: int, polish: int = 0) -> Fit:
        def compute() -> dict[str, Any]:
            return fit(self.rig, self.cells, tuple(names), starts, budget, self.seed, polish).as_json()

        return Fit.from_json(self.ledger.keep(f"{self.path}{key}, {budget} tables", compute))


def different(fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits within `RIVALS` of the lowest, the lowest first, without those that end where a lower one does."""
    ordered = sorted(fits, key=lambda one: one.loss)
    kept: list[Fit] = []
    for one in ordered:
        there = any(all(abs(one.places[name] - place) <= WIDEST for name, place in other.places.items()) for other in kept)
        if one.loss <= ordered[0].loss + RIVALS and not there:
            kept.append(one)
    return kept
