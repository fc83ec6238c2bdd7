"""What a search finds: fitted models with what they leave of blocks left out, and one look at what a model misses."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hjcamp.diagnosis.estimation.gauss_newton import Fitted
from hjcamp.diagnosis.levels import LEVEL
from hjcamp.diagnosis.residuals.windows import Place
from hjcamp.diagnosis.screening.chance import DRAWS

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scored:
    """A fitted model with what it was made of, and its features (windows, d) on held-out blocks, with their size.

    ``place`` is where the windows begin for it. Two are equal where they are one.
    """

    names: tuple[str, ...]
    fitted: Fitted
    features: Array
    left_out: float
    place: Place

    def beyond(self, other: Scored) -> tuple[str, ...]:
        """Return the names of effects that another model lacks."""
        return tuple(name for name in self.names if name not in other.names)


class Follows(NamedTuple):
    """The share of a model's rms that follows from the motion, and the logarithm of the factor by which `size` falls without it."""

    share: float
    taken: float


@dataclass(frozen=True)
class Step:
    """One look at what is missing in addition to ``before``: chance of the best gain, and every model that was fitted.

    ``claims`` is the level of all that may be claimed of named effects, and of unknowns. ``orders`` is how many different orders of the
    windows chance was drawn from: of one test of n windows there are n - 1. ``decoys`` and ``replicates`` are what else chance promises
    (`hjcamp.diagnosis.screening.chance.Chance`).
    """

    before: Scored
    p_value: float
    chance: Array
    gain: float
    named: tuple[Scored, ...]
    unknown: tuple[Scored, ...]
    claims: float = LEVEL
    orders: int = DRAWS
    decoys: Array = field(default_factory=lambda: np.zeros(0))
    replicates: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def told(self) -> float:
        """The chance that may be told: no smaller than the different orders allow, however often each was drawn."""
        return max(self.p_value, 1.0 / (1.0 + self.orders))

    @property
    def false_claims(self) -> dict[str, float]:
        """How often as much as was found is promised where nothing is: of null replicates, of moved residuals, of decoys."""
        drawn = {"twins": self.replicates, "shifted": self.chance, "decoys": self.decoys}
        return {name: float(np.mean(gains >= self.gain)) for name, gains in drawn.items() if len(gains)}

    @property
    def level(self) -> float:
        """The level of each named model's comparison with ``before``: the best of all is taken (Bonferroni)."""
        return self.claims / max(len(self.named), 1)

    @property
    def level_of_unknown(self) -> float:
        """The level of each unknown's comparison."""
        return self.claims / max(len(self.unknown), 1)
