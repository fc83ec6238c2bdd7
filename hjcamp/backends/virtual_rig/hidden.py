"""What a virtual rig has and its model does not: effects with the values that are said, or drawn from a seed."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from hjcamp.backends.plant_simulation import plant_in
from hjcamp.effects import find_effect
from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.plant import Plant

#: What is drawn lies within this factor of the library's own value.
FACTOR = 2.0
Hidden = dict[str, dict[str, float]]


def hidden_config(config: Mapping[str, Any], hide: Sequence[str], seed: int) -> tuple[dict[str, Any], Hidden]:
    """Return a configuration with what is hidden added, and that alone.

    Each of ``hide`` is ``EFFECT`` (its parameters are drawn), ``EFFECT.PARAMETER=VALUE``, or ``EFFECT=VALUE`` where it has one.
    """
    if not config.get("plant"):
        raise UsageError("what is hidden is said of another plant than the joint: plant=NAME")
    plant, generator = plant_in(config), np.random.default_rng(seed)
    found: Hidden = {}
    for text in hide:
        key, equals, value = text.partition("=")
        name, dot, parameter = key.strip().partition(".")
        effect = find_effect(name, plant)
        if not equals:
            if dot:
                raise UsageError(f"--hide {text}: give it as {name}.{parameter}=VALUE, or {name} alone")
            found[name] = {one: _drawn(item, generator) for one, item in effect.parameters.items()}
            continue
        if not dot and len(effect.parameters) != 1:
            raise UsageError(f"--hide {text}: {name} has {', '.join(effect.parameters)}; say which: {name}.PARAMETER=VALUE")
        parameter = parameter or next(iter(effect.parameters))
        if parameter not in effect.parameters:
            raise unknown("parameter", parameter, effect.parameters, f"--hide {text}")
        try:
            number = float(value)
        except ValueError:
            raise UsageError(f"--hide {text}: '{value[:40]}' is no number") from None
        found.setdefault(name, {})[parameter] = effect.parameters[parameter].checked(number, f"--hide {key}")
    known = copy.deepcopy(dict(config))
    known["effects"] = {**(known.get("effects") or {}), **found}
    return known, found


def _drawn(parameter: Any, generator: np.random.Generator) -> float:
    low, high = parameter.bounds
    return float(np.clip(parameter.default * FACTOR ** generator.uniform(-1.0, 1.0), low, high))


def hidden_words(plant: type[Plant], hidden: Hidden) -> Iterator[str]:
    """Yield what was hidden, one line for each effect, with all its values."""
    for name, values in hidden.items():
        parameters: Mapping[str, Any] = find_effect(name, plant).parameters
        told = (f"{one} {values.get(one, item.default):.5g} {item.unit}" for one, item in parameters.items())
        yield f"{name}: {', '.join(told)}"
