"""What costs how much: each part of the rig made better by a share, the gains tuned again, the error before and after."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.simulation import model_values, run_test
from hjcamp.plants.pump_joint.studies.retune import gains_of, retune
from hjcamp.records.plan import Condition

Values = dict[str, float]
SIDES = ("positive", "negative")
KINDS = ("static", "coulomb", "viscous")
NOTHING = "nothing"
#: Gains are tuned on so many tests with scatter, whose seeds begin so far behind those of the tests that judge them.
DRAWS, BEHIND = 8, 1000


@dataclass(frozen=True)
class Item:
    """One row: RMSE1 and largest error (deg) of each repetition, with the gains as they were and tuned again.

    ``retuned`` is empty where the gains were left, or diverge; ``problem`` says why a row has no numbers.
    """

    name: str
    kept: NDArray[np.float64]
    retuned: NDArray[np.float64]
    problem: str = ""

    @property
    def best(self) -> NDArray[np.float64]:
        """The errors to judge by, (repetitions, 2): with gains tuned again where that was done and did not harm."""
        if not len(self.retuned):
            return self.kept
        return min(self.kept, self.retuned, key=lambda one: float(one[:, 0].mean()))


def better_by(values: Mapping[str, float], share: float) -> dict[str, Values]:
    """Return for each base part the plant parameters (SI) of a rig whose part is down to ``share``.

    Lag: all three poles of the pump are 1/share times faster. Friction difference: both directions nearer to their mean.
    """
    friction = {f"{kind}_{side}": values[f"{kind}_{side}"] for kind in KINDS for side in SIDES}
    above = {f"static_{side}": values[f"static_{side}"] - values[f"coulomb_{side}"] for side in SIDES}
    mean = {kind: 0.5 * sum(values[f"{kind}_{side}"] for side in SIDES) for kind in KINDS}
    lag = {"pump_a2": 1, "pump_a1": 2, "pump_a0": 3, "pump_gain": 3}
    return {
        "friction": {name: share * value for name, value in friction.items()},
        "static above Coulomb friction": {name: values[name] - (1.0 - share) * excess for name, excess in above.items()},
        "viscous friction": {name: share * friction[name] for name in friction if name.startswith("viscous")},
        "friction difference of the directions": {
            name: mean[name.partition("_")[0]] + share * (value - mean[name.partition("_")[0]])
            for name, value in friction.items()
        },
        "compliance of the lines": {"line_stiffness": values["line_stiffness"] / share},
        "moving mass": {"moving_mass": share * values["moving_mass"]},
        "lag of the pump": {name: values[name] / share**power for name, power in lag.items()},
        "delay of the pump": {"pump_delay": share * values["pump_delay"]},
        "step of the arm encoder": {"encoder_count": share * values["encoder_count"]},
    }


def variants(config: Mapping[str, Any], share: float) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name and configuration of the rig as it is, of each part made better, and of each effect removed.

    The controller's own model learns the base part too. Less friction lessens the initial adjustment, as in 5.6.
    """
    yield NOTHING, copy.deepcopy(dict(config))
    values, effects = model_values(config)
    for name, better in better_by(values, share).items():
        changed = copy.deepcopy(dict(config))
        for group in ("model", "controller_model"):
            if changed.get(group) is not None:
                changed[group]["parameters"] = {**(changed[group].get("parameters") or {}), **better}
        if name == "friction":
            for side in SIDES:
                changed["procedure"]["adjustment"][f"{side}_mpa"] *= share
        yield name, changed
    for effect in effects:
        changed = copy.deepcopy(dict(config))
        for holder in (changed, changed["model"]):
            (holder.get("effects") or {}).pop(effect, None)
        yield f"effect {effect}", changed


def budget(
    condition: Condition,
    share: float,
    repetitions: int,
    seed: int,
    tuned: bool,
    notice: Callable[[str, float], None] = lambda name, done: None,
) -> list[Item]:
    """Return a row for the rig as it is, then for each better part, smallest mean RMSE1 first.

    ``notice`` gets the part under way and the share of the work done. A part that cannot be simulated has its reason.
    """
    cases = list(variants(condition.config, share))
    items = []
    for number, (name, config) in enumerate(cases):
        notice(name, number / len(cases))
        try:
            kept = errors_of(config, repetitions, seed)
            retuned = np.empty((0, 2))
            if tuned:
                draws = range(seed + BEHIND, seed + BEHIND + DRAWS)
                found = retune([replace(condition, config=config)], gains_of(config, name), seed, draws=draws)
                with suppress(HjcampError):  # gains that run away in another test: those as they were stand
                    retuned = errors_of({**config, "controller": {**config["controller"], **found.gains}}, repetitions, seed)
            items.append(Item(name, kept, retuned))
        except HjcampError as problem:
            items.append(Item(name, np.empty((0, 2)), np.empty((0, 2)), str(problem)))
    rest = [one for one in items[1:] if not one.problem]
    failed = [one for one in items[1:] if one.problem]
    return [items[0], *sorted(rest, key=lambda one: float(one.best[:, 0].mean())), *failed]


def errors_of(config: Mapping[str, Any], repetitions: int, seed: int) -> NDArray[np.float64]:
    """Return RMSE1 and largest error (deg) of each repetition, (repetitions, 2); the same draws for every part."""
    rows = []
    for repetition in range(repetitions):
        columns, _ = run_test(dict(config), seed + repetition)
        moving = columns["phase"] == 3.0
        error = (columns["reference_deg"] - columns["arm_deg"])[moving]
        rows.append((float(np.sqrt(np.mean(error**2))), float(np.max(np.abs(error)))))
    return np.array(rows)
