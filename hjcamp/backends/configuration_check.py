"""What every backend asks of a configuration before anything is run: effects, controller and model that exist."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from hjcamp.backends.simulation import control_values, model_values
from hjcamp.controllers import find_controller
from hjcamp.effects import chosen_effects
from hjcamp.errors import UsageError, unknown
from hjcamp.model.compose import Composition
from hjcamp.model.effect import Effect
from hjcamp.plants.pump_joint import PumpJoint

OWN_EFFECTS = "hjcamp.effects."
FASTEST_DITHER_HZ = 500.0  # a half period is at least one sample
SIDES = ("positive", "negative")
SETTINGS: dict[str, tuple[str, ...]] = {
    "name": (),
    "model": (),
    "gain_direction_at_rest": (),
    "dither": ("amplitude_v", "frequency_hz", "full_scale_v", "waveform"),
    "feedforward": ("variant", "gain", "static_friction", "friction_direction"),
}
WORDS = {
    "gain_direction_at_rest": ("last_commanded",),
    "dither.waveform": ("square",),
    "feedforward.friction_direction": ("reference", "positive"),
}


def check_configuration(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` for an unknown effect, controller or parameter of one, and for a value out of bounds."""
    _check_shape(config.get("effects"), "effects")
    _check_shape(config["model"].get("effects"), "model.effects")
    values, given = model_values(config)
    effects, _ = chosen_effects(given)
    _check_model(values, effects, "model.parameters")
    known = config.get("controller_model") or {}
    thought, _ = chosen_effects(known.get("effects") or {})
    _check_model(
        known.get("parameters") or {}, thought, f"model '{config['controller'].get('model')}' of the controller"
    )
    check_controller(config)


def check_controller(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` for a setting that the chosen control law does not have, and for a value out of bounds."""
    given = config["controller"]
    law = find_controller(str(given.get("name")))
    allowed = _nested(law.parameters) | SETTINGS
    for key, value in given.items():
        if key not in allowed:
            raise unknown("parameter", str(key), allowed, f"controller '{law.name}'")
        if isinstance(value, Mapping):
            for name in value:
                if name not in allowed[key]:
                    raise unknown("parameter", str(name), allowed[key], f"controller.{key}")
    for path, words in WORDS.items():
        group, _, name = path.rpartition(".")
        holder = given.get(group) or {} if group else given
        if name in holder and holder[name] not in words:
            raise unknown("value", str(holder[name]), words, f"controller.{path}")
    for name, number in control_values(config, law, 1.0).items():
        low, high = law.parameters[name].bounds if name in law.parameters else (-math.inf, math.inf)
        if isinstance(number, bool) or not isinstance(number, int | float) or not low <= number <= high:
            path = name.replace("positive_", "positive.").replace("negative_", "negative.")
            raise UsageError(f"controller.{path} is {number!r}; a number from {low:g} to {high:g} is needed")
    _check_dither(given.get("dither") or {})


def _check_shape(effects: Any, where: str) -> None:
    if not isinstance(effects or {}, Mapping):
        raise UsageError(f"{where} is {effects!r}; give effects as name: {{parameter: value}}")
    for name, given in (effects or {}).items():
        if not isinstance(given or {}, Mapping):
            raise UsageError(f"{where}.{name} is {given!r}; give its parameters as {where}.{name}.PARAMETER=VALUE")


def _check_dither(dither: Mapping[str, Any]) -> None:
    if not dither:
        return
    for name, low, high in (("amplitude_v", 0.0, 1000.0), ("frequency_hz", 1e-3, FASTEST_DITHER_HZ)):
        value = dither.get(name)
        if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
            raise UsageError(f"controller.dither.{name} is {value!r}; a number from {low:g} to {high:g} is needed")


def _nested(parameters: Iterable[str]) -> dict[str, tuple[str, ...]]:
    allowed: dict[str, tuple[str, ...]] = {}
    for parameter in parameters:
        side, _, gain = parameter.partition("_")
        if side in SIDES and gain:
            allowed[side] = (*allowed.get(side, ()), gain)
        elif parameter != "first_direction":
            allowed[parameter] = ()
    return allowed


def _check_model(values: Mapping[str, float], effects: list[type[Effect]], where: str) -> None:
    known = Composition(PumpJoint, tuple(effects)).parameters
    for name in values:
        if name not in known:
            raise unknown("parameter", name, known, where)
    for effect in effects:
        # Ours are checked by the tests; a user's file may have been saved a moment ago.
        if not effect.__module__.startswith(OWN_EFFECTS):
            from hjcamp.model.effect_units import check_units

            check_units(effect, PumpJoint)
