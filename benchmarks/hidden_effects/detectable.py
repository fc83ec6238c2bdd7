"""What can be seen of a hidden effect in a campaign, told by the truth plant alone, without any diagnosis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from truth.pump_joint.case import Case, build_case
from truth.pump_joint.plant import JOINT_AREA, Plant
from truth.pump_joint.visibility import CHANNELS, scaled_change, simulate_means

from benchmarks.hidden_effects.cases import HiddenCase

Array = NDArray[np.float64]
# An effect is detectable from this change on, in standard deviations of one repetition.
DETECTABLE = 1.0
STEP = 0.03
# Groups of base parameters that a rig may have otherwise, their signs, and by how much (share).
BASE = (
    *(({f"{kind}_{way}": 1.0}, 0.6) for kind in ("static", "coulomb", "viscous") for way in ("positive", "negative")),
    ({"stiffness1": 1.0, "stiffness2": 1.0}, 0.3),
    ({"stiffness1": 0.5, "stiffness2": -0.5}, 0.02),
    ({"slider_mass": 1.0, "arm_mass": 1.0}, 0.15),
)


@dataclass
class Campaign:
    """One rig with nothing hidden and its open-loop tests: closed loops answer any change by other slips."""

    seed: int
    contact: str = "asperities"

    def __post_init__(self) -> None:
        """Simulate the tests with nothing hidden."""
        case = build_case((), seed=self.seed, contact=self.contact)
        self.case = replace(case, conditions=tuple(one for one in case.conditions if not one.closed_loop))
        self.null, self.scatters = simulate_means(self.case)

    def change(self, case: Case) -> list[Array]:
        """Return the change of the mean logs of every condition, (channels, n) each, over the scatter of one repetition."""
        return scaled_change(simulate_means(replace(case, conditions=self.case.conditions))[0], self.null, self.scatters)

    @cached_property
    def base(self) -> Array:
        """The change by ``STEP`` of each group of base parameters (samples, groups)."""
        columns = []
        for signs, _ in BASE:
            values = {name: getattr(self.case.plant, name) * (1 + STEP * sign) for name, sign in signs.items()}
            moved = replace(self.case, plant=self.case.plant._replace(**values))
            columns.append(np.concatenate([part.ravel() for part in self.change(moved)]))
        return np.array(columns).T

    def visible(self, effect: str, strength: str | float) -> tuple[float, str]:
        r"""Return how far an effect changes the logs beyond the base parameters, and where most.

        .. math:: v = \max_{c,k} \sqrt{\Bigl\langle \Bigl(\frac{\bar y^{hidden}_{ck} - \bar y^{null}_{ck}
                  - (B b)_{ck}}{s_{ck}}\Bigr)^2 \Bigr\rangle_t}

        over conditions c and channels k; means and scatter s over the repetitions, the same draws of scatter with and
        without the effect; b (bounded least squares) is what other base parameters imitate. Slips answer no small change
        in proportion: where physics says which friction balances the effect, that rig is looked at, too.
        """
        hidden = build_case((effect,), strength, self.seed, contact=self.contact, form="random")
        rigs = [hidden.plant, *balanced(hidden.plant)]
        return min(self.beyond_base(self.change(replace(hidden, plant=plant))) for plant in rigs)

    def beyond_base(self, change: list[Array]) -> tuple[float, str]:
        """Return the largest root mean square of a change beyond the base parameters, and where it is."""
        from scipy.optimize import lsq_linear

        flat = np.concatenate([part.ravel() for part in change])
        most = np.array([share / STEP for _, share in BASE])
        # the triangle of Q R holds all that the bounded problem needs of the many samples
        orthogonal, triangle = np.linalg.qr(self.base)
        taken = lsq_linear(triangle, orthogonal.T @ flat, bounds=(-most, most)).x
        left, best, place, start = flat - self.base @ taken, 0.0, "", 0
        for condition, part in zip(self.case.conditions, change, strict=True):
            rest = left[start : start + part.size].reshape(part.shape)
            start += part.size
            levels = np.sqrt(np.mean(rest**2, axis=1))
            if levels.max() > best:
                best, place = float(levels.max()), f"{condition.name}/{CHANNELS[int(levels.argmax())]}"
        return best, place


def balanced(plant: Plant) -> list[Plant]:
    """Return the plant whose friction balances what its pressure sensors' offsets pretend: a constant force, N."""
    force = JOINT_AREA * (plant.pressure1_offset - plant.pressure2_offset)
    if force == 0.0:
        return []
    ways = {"positive": -force, "negative": force}
    return [
        plant._replace(
            **{
                f"{kind}_{way}": max(getattr(plant, f"{kind}_{way}") + more, 0.0)
                for kind in ("static", "coulomb")
                for way, more in ways.items()
            }
        )
    ]


def visibility(case: HiddenCase) -> dict[str, tuple[float, str]]:
    """Return how visible each effect of a case is by itself on its rig."""
    if not case.effects:
        return {}
    campaign = Campaign(case.seed, case.contact)
    return {effect: campaign.visible(effect, case.strength) for effect in case.effects}
