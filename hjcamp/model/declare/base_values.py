"""The values of a plant's parameters and the delays of its inputs, as a configuration or a saved model gives them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.model.declare.plant import Plant

DELAY = "delay."


def checked_base(given: object, plant: type[Plant], where: str) -> dict[str, float]:
    """Return values by name, SI; ``delay.INPUT`` (s) says how much later than its log an input acts on the plant (earlier: negative).

    ``delay: {INPUT: value}`` says the same. Raises ``UsageError`` for a name or a value that the plant cannot have.
    """
    if not isinstance(given or {}, Mapping):
        raise UsageError(f"{where} is {shown(given)}; give each as {where}.NAME=VALUE, in SI units")
    found = {}
    for name, value in _flat(given or {}).items():
        if name.startswith(DELAY):
            found[name] = _delay(name, value, plant, where)
        elif name in plant.parameters:
            found[name] = plant.parameters[name].checked(value, f"{where}.{name}")
        else:
            raise unknown("parameter", name, plant.parameters, f"{where} of plant {plant.name}")
    return found


def period_of(model: Mapping[str, Any], where: str) -> float:
    """Return the time between the samples (s) of the logs that a saved model was fitted to; 0 where it does not say."""
    value = model.get("period_s", 0.0)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= float(value) < 1e6:
        raise UsageError(f"{where}.period_s is {shown(value)}; the time between two samples in seconds is needed")
    return float(value)


def _flat(given: Any) -> dict[str, Any]:
    whole = {str(name): value for name, value in given.items()}
    late = whole.pop(DELAY[:-1], None) if isinstance(whole.get(DELAY[:-1]), Mapping) else None
    return whole | {f"{DELAY}{name}": value for name, value in (late or {}).items()}


def _delay(name: str, value: object, plant: type[Plant], where: str) -> float:
    known = plant.given_inputs()
    if name.removeprefix(DELAY) not in known:
        raise unknown("input", name.removeprefix(DELAY), known, f"{where}.{name} of plant {plant.name}")
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(float(value)) < 1e6:
        raise UsageError(f"{where}.{name} is {shown(value)}; a delay in seconds is needed")
    return float(value)
