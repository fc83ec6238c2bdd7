"""One of exactly five verdicts from what the search found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hjcamp.model.declare.effect import Effect
from hjcamp.plants.pump_joint.diagnosis.bootstrap.null_distribution import Null
from hjcamp.plants.pump_joint.diagnosis.fitting.gauss_newton import Fit
from hjcamp.plants.pump_joint.diagnosis.levels import exact, law
from hjcamp.plants.pump_joint.diagnosis.localisation.drivers import (
    bends,
    driver_values,
    foreign_shares,
    outdone,
    share_left,
)
from hjcamp.plants.pump_joint.diagnosis.measured.evidence import Evidence
from hjcamp.plants.pump_joint.diagnosis.residuals.features import Features
from hjcamp.plants.pump_joint.diagnosis.residuals.views import CHANNELS, Views
from hjcamp.plants.pump_joint.diagnosis.screening.screening import Step

POSTERIOR = 0.8
APART = 0.5
SLIDING = CHANNELS.index("sliding")
SHARE = 0.15
TRAVEL = math.radians(20)
LEAST_TESTS = 3
AGAINST = {
    "left": "what {effect} leaves still depends on {driver}, in which its law is exact",
    "straight": "what looks like {effect} follows {driver} in a straight line",
    "bent": "what looks like {effect} follows {driver} from one place on only",
}
FOREIGN = {
    "arm_angle": "no effect of the library explains a force that depends on the arm's angle",
    "time": "no effect of the library explains a force that oscillates with one frequency in all tests",
}


@dataclass(frozen=True)
class Verdict:
    """The verdict, the effects it names, the reason in words, and the driver that refutes an effect (or nothing).

    ``undecided`` are the effects of which one is needed as well and these tests cannot tell which.
    """

    verdict: str
    effects: list[str]
    reason: str
    driver: str = ""
    undecided: tuple[str, ...] = ()


def judge(
    views: Views,
    features: Features,
    null: Null,
    base: Fit,
    final: Fit,
    steps: Sequence[Step],
    taken: Sequence[Step],
    effects: Sequence[type[Effect]],
) -> Verdict:
    """Return the verdict; ``null`` are twins of the final model, ``effects`` the library; of ``steps`` those ``taken`` count."""
    evidence = features.evidence
    if lacking := lacks(evidence):
        return Verdict("cannot_tell", [], "; ".join(lacking))
    named = named_by(taken, effects)
    excess = null.excess(base.mean_square, final.mean_square, law_of(named))
    if np.any(excess > 1.0):
        worst = int(np.argmax(excess))
        over = float(null.over(final.mean_square)[worst])
        return Verdict("outside_library", [], f"the best model leaves {over:.2f} x the rig's own scatter in {CHANNELS[worst]}")
    for effect in named:
        for driver in effect.exact_in:
            for kind, size in against(views, features, final, effect.name, driver).items():
                if size > exact(kind):
                    reason = AGAINST[kind].format(effect=effect.name, driver=driver.replace("_", " "))
                    return Verdict("outside_library", [], reason, driver)
    if not taken:
        # a law in the model that is off in form leaves harmonics of the motion
        driver = "" if final.candidate.effects else _foreign(features, null, final)
        if driver:
            return Verdict("outside_library", [], FOREIGN[driver], driver)
        return Verdict("nothing_missing", [], "no effect gains more than in null replicates with nothing missing")
    return weighed([(step.best, rivals_of(step, taken, steps)) for step in taken])


def weighed(found: Sequence[tuple[str, list[str]]]) -> Verdict:
    """Return the verdict of steps that are needed, each by its best effect and what it cannot be told apart from.

    What is certain is named, unless the first step, which explains most, is doubtful itself.
    """
    certain = [best for best, rivals in found if not rivals]
    doubtful = next((rivals for _, rivals in found if rivals), [])
    if not doubtful:
        return Verdict("effect", certain, "the error falls to repeatability")
    if not found[0][1]:
        reason = f"in addition one of {', '.join(doubtful)} is needed; these tests fit them equally well, others can decide"
        return Verdict("effect", certain, reason, undecided=tuple(doubtful))
    beside = f"; {' and '.join(certain)} in addition is certain" if certain else ""
    return Verdict("one_of", doubtful, f"these tests fit them equally well{beside}", undecided=tuple(doubtful))


def _foreign(features: Features, null: Null, final: Fit) -> str:
    """Return the driver that no base parameter knows of on which the error depends more than in any twin, or nothing."""
    seen = foreign_shares(features, [final.features])[0]
    replicates = foreign_shares(features, null.residuals) if max(seen.values()) > SHARE else []
    over = {driver: share - max([SHARE, *(copied[driver] for copied in replicates)]) for driver, share in seen.items()}
    driver = max(over, key=lambda name: over[name])
    return driver if over[driver] > 0 else ""


def against(views: Views, features: Features, final: Fit, name: str, driver: str) -> dict[str, float]:
    """Return what speaks against a law that is exact in a driver: the share of the force that still depends on it, and by how
    many standard errors a straight line, or one that sets in at one place, fits what the effect is to explain better.
    """
    force = features.of(views.residuals(final.candidate.without([name])))[:, SLIDING]
    law = force - final.features[:, SLIDING]
    values = driver_values(features)
    valid, sign = features.valid[:, SLIDING], values["direction"]
    along = values[driver]
    return {
        "left": share_left(features, final, driver),
        "straight": outdone(features, force, law, [along], sign, valid),
        "bent": outdone(features, force, law, bends(along, valid), sign, valid),
    }


def rivals_of(step: Step, taken: Sequence[Step], steps: Sequence[Step] = ()) -> list[str]:
    """Return the effects that a step cannot tell apart, likeliest first; none where its best one is certain.

    What gains as much beside the best one explains something else, and is no rival of it: the step after it tells.
    """
    others = {other.best for other in taken if other is not step}
    for later in [other for other in steps if other.screening.about is step.fits[step.best]]:
        others |= {name for name in later.fits if name in step.fits and later.gain_of(name) > APART * step.gain_of(name)}
    weights = {name: weight for name, weight in step.weights.items() if name not in others}
    total = sum(weights.values())
    rivals = [name for name, weight in weights.items() if weight > 0.5 * (1 - POSTERIOR) * total]
    certain = weights[step.best] >= POSTERIOR * total or len(rivals) < 2
    return [] if certain else sorted(rivals, key=lambda name: -weights[name])


def named_by(taken: Sequence[Step], effects: Sequence[type[Effect]]) -> list[type[Effect]]:
    """Return the effects of the library that the steps taken have added."""
    return [effect for effect in effects if any(effect.name == step.best for step in taken)]


def law_of(named: Sequence[type[Effect]]) -> float:
    """Return the share by which the laws of the named effects may be off: none where all are exact, or none is named."""
    return 0.0 if all(effect.exact_in for effect in named) else law()


def lacks(evidence: Evidence) -> list[str]:
    """Return everything that the tests lack for any verdict, each with what is needed."""
    moving = [test for test in evidence.tests if np.ptp(test.arm) > TRAVEL]
    found = []
    if len(evidence.tests) < LEAST_TESTS:
        found.append(
            f"{len(evidence.tests)} test(s); at least {LEAST_TESTS} are needed, better several conditions with 3 repetitions each"
        )
    if len(evidence.conditions) < 2:
        found.append("one condition only: one preload, one speed; most effects look similar here")
    if len(moving) < 2:
        turned = f"it turns by more than {math.degrees(TRAVEL):.0f} deg in {len(moving)} of them, 2 are needed"
        found.append(f"the arm hardly moves in these tests: {turned}")
    return found
