"""What effects can change of a view: the parameters that reach its outputs, and the effects without which these are the same."""

from __future__ import annotations

import functools
import re
from typing import Any

import numpy as np

from hjcamp.model.compile.structure import influences, reaching
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import composition


@functools.lru_cache(maxsize=512)
def reaching_places(effects: tuple[Any, ...], cut: str, present: frozenset[str], outputs: tuple[str, ...]) -> Any:
    """Return the positions of the parameters that reach the outputs when only some effects are present."""
    whole = composition(effects, cut)
    some = composition(tuple(effect for effect in effects if effect.name in present), cut, gated=False)
    names = influences(some, outputs)
    return np.array([position for position, name in enumerate(whole.parameters) if name in names], dtype=np.int64)


@functools.lru_cache(maxsize=64)
def gates_of(effects: tuple[Any, ...]) -> dict[str, int]:
    """Return the position of every effect's gate among the parameters."""
    order = list(composition(effects, "pump").parameters)
    return {effect.name: order.index(f"gate.{effect.name}") for effect in effects}


@functools.lru_cache(maxsize=512)
def idle(effects: tuple[Any, ...], cut: str, outputs: tuple[str, ...]) -> frozenset[str]:
    """Return the names of those effects without which the outputs are computed in the same way."""
    left = effects
    for effect in effects:
        fewer = tuple(other for other in left if other is not effect)
        if _computed(fewer, cut, outputs) == _computed(left, cut, outputs):
            left = fewer
    return frozenset(effect.name for effect in effects if effect not in left)


def _computed(effects: tuple[Any, ...], cut: str, outputs: tuple[str, ...]) -> str:
    # The places of states and parameters in their vectors depend on what else there is; their names tell.
    return re.sub(r"\[\d+\]", "", reaching(composition(effects, cut, gated=False), outputs))


def shows_otherwise(effect: Any) -> bool:
    """Whether an effect stands between the joint and what its sensors show."""
    return any(slot == "arm_angle" or slot.endswith("_reading") for slot in effect.terms)


def balances_itself(effect: Any) -> bool:
    """Whether an effect takes its force from the acceleration, which the force balance is there to explain."""
    terms = (*effect.terms.values(), *effect.rates.values(), *effect.updates.values())
    return any("slider_acceleration" in term.arguments for term in terms)
