"""The forward search: base, then one candidate at a time while surrogate tables do not gain as much by chance."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.tabulated.cells import Cells, robust
from hjcamp.tabulated.fit import Fit, fit
from hjcamp.tabulated.ledger import Ledger
from hjcamp.tabulated.probes import Looked, look
from hjcamp.tabulated.quantities import base_quantities
from hjcamp.tabulated.rig import Rig
from hjcamp.workers.pool import Crew

Array = NDArray[np.float64]
#: Chance of a gain as large on a table in which nothing is missing, from which on it is no reason to add anything.
LEVEL = 0.05
#: What a further quantity costs, so that laws with many do not win by their number (Akaike 1974).
COST = 2.0


@dataclass(frozen=True)
class Effort:
    """How long is searched: simulated tables of each fit, candidates refitted in a step, twins, steps."""

    base: int
    short: int
    long: int
    refitted: int
    twins: int
    steps: int


EFFORTS = {
    "quick": Effort(base=400, short=40, long=250, refitted=2, twins=4, steps=4),
    "standard": Effort(base=1500, short=150, long=1000, refitted=5, twins=19, steps=5),
    "thorough": Effort(base=4000, short=400, long=3000, refitted=8, twins=39, steps=6),
}


@dataclass(frozen=True)
class Step:
    """One step: the model before, the control (refitted alike), its rivals with a candidate each, the twins' gains."""

    before: Fit
    control: Fit
    rivals: Sequence[Fit]
    twins: Sequence[float]

    @property
    def gain(self) -> float:
        """The fall of the loss by the best rival, less the cost of its quantities."""
        return gain_of(self.control, self.rivals)

    @property
    def p_value(self) -> float:
        r"""The chance of such a gain: that of a Gumbel law through mean and deviation of the twins' largest gains.

        Source: Abrams, Kulldorff & Kleinman (2010), Int. J. Health Geographics 9:61. Without twins the gain is not tested.
        """
        if len(self.twins) < 2:
            return 1.0
        scale = max(float(np.std(self.twins, ddof=1)) * math.sqrt(6) / math.pi, 0.5)
        location = float(np.mean(self.twins)) - 0.5772 * scale
        return -math.expm1(-math.exp(-(self.gain - location) / scale))


def gain_of(control: Fit, rivals: Sequence[Fit]) -> float:
    """Return the largest fall of the loss, less the cost of the quantities that it takes."""
    return max((control.loss - penalised(one, control) for one in rivals), default=0.0)


def penalised(rival: Fit, control: Fit) -> float:
    """Return the loss of a rival with the cost of the quantities that it has more than the control."""
    return rival.loss + COST * (len(rival.places) - len(control.places))


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
    looked: dict[int, Looked] = field(default_factory=dict)

    @property
    def one(self) -> Rig:
        """One repetition of each condition: what a long search can afford."""
        return self.rig.repeated(1)

    def base(self) -> Fit:
        """Return the base fitted from the published constants, and from them without a drop of friction; the better."""
        self.report("fitting the base", 0.02)
        level = {one.name: one.forth(1.0) for one in base_quantities() if one.name.startswith("drop_")}
        starts: list[tuple[str, Mapping[str, float]]] = [("as printed", {}), ("without a drop of friction", level)]

        def fitted(item: tuple[str, Mapping[str, float]]) -> Fit:
            name, start = item
            return self._fit(f"base {name}", self.cells, (), [start], self.effort.base)

        return min(self.crew.together(fitted, starts), key=lambda one: one.loss)

    def step(self, number: int, model: Fit) -> Step:
        """Return the candidates beside the control, and what the same search gains on twins of ``model``."""
        begin, share = 0.1 + 0.8 * number / self.effort.steps, 0.8 / self.effort.steps
        names = [name for name in self.names if name not in model.names]
        looked = look(
            self.one, self.cells, model, names, lambda at: self.report(f"looking at {len(names)} candidates", begin + 0.2 * share * at)
        )  # fmt: skip
        self.looked[number] = looked
        self.report(f"step {number + 1}: fitting what promises most", begin + 0.2 * share)
        control, rivals = self._rivals(f"step {number}", looked, self.cells)
        gains: list[float] = []
        for twin in range(self.effort.twins):
            if sum(gain >= gain_of(control, rivals) for gain in gains) > LEVEL * (1 + self.effort.twins):
                break  # whatever the others gain, this is chance
            self.report(
                f"step {number + 1}: twin {twin + 1} of {self.effort.twins}",
                begin + share * (0.3 + 0.7 * twin / self.effort.twins),
            )
            target = self.cells.drawn(looked.simulated, np.random.default_rng([self.seed, number, twin]))
            gains.append(gain_of(*self._rivals(f"step {number} twin {twin}", looked, target)))
        return Step(model, control, rivals, gains)

    def longer(self, number: int, model: Fit) -> Fit:
        """Return an accepted model searched for longer, first with one repetition, then with three."""
        self.report(
            f"step {number + 1}: fitting {', '.join(model.names)} for longer",
            0.1 + 0.8 * (number + 0.9) / self.effort.steps,
        )

        def fitted(seed: int) -> Fit:
            return self._fit(
                f"longer {number} seed {seed}", self.cells, model.names, [model.places], self.effort.long, seed
            )

        return min(self.crew.together(fitted, (1, 2)), key=lambda one: one.loss)

    def run(self) -> tuple[Fit, list[Step]]:
        """Return the accepted model and every step, the one that adds nothing as the last."""
        model, steps = self.base(), []
        for number in range(self.effort.steps):
            found = self.step(number, model)
            steps.append(found)
            if found.gain <= 0.0 or found.p_value > LEVEL:
                return min(model, found.control, key=lambda one: one.loss), steps
            model = self.longer(number, min(found.rivals, key=lambda one: penalised(one, found.control)))
        return model, steps

    def losses_of_twins(self, model: Fit, rig: Rig) -> list[float]:
        """Return the loss of a model on tables of its own: what is left where nothing is missing."""
        simulated = self.cells.of(rig.indicators(model.settings))
        generator = np.random.default_rng([self.seed, 99])
        return [float(robust(self.cells.drawn(simulated, generator).errors(simulated)).sum()) for _ in range(199)]

    def _rivals(self, key: str, looked: Looked, cells: Cells) -> tuple[Fit, list[Fit]]:
        """Refit the model and its rivals alike: each from where the model is and from its linear refit, for as long."""
        model, short = looked.model, self.effort.short
        here = model.places
        items = [("control", model.names, [here, looked.refitted(cells)])]
        for probe in looked.promising(cells, self.effort.refitted):
            items.append((probe.name, (*model.names, probe.name), [{**probe.places, **here}, probe.places]))

        def fitted(item: tuple[str, tuple[str, ...], list[Mapping[str, float]]]) -> Fit:
            name, names, starts = item
            return self._fit(f"{key} {name}", cells, names, starts, short)

        control, *rivals = self.crew.together(fitted, items)
        return control, rivals

    def _fit(
        self,
        key: str,
        cells: Cells,
        names: Sequence[str],
        starts: Sequence[Mapping[str, float]],
        budget: int,
        seed: int = 0,
    ) -> Fit:
        def compute() -> dict[str, Any]:
            return fit(self.one, cells, tuple(names), starts, budget, self.seed * 1000 + seed).as_json()

        return Fit.from_json(self.ledger.keep(f"{key}, {budget} tables", compute))
