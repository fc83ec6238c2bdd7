"""The check of a resolved configuration of this joint: its groups, rig, controller and model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.configuration.file_models import SavedModel
from hjcamp.configuration.run_keys import RunKeys, read_run_keys
from hjcamp.controllers import find_controller
from hjcamp.controllers.controller import Controller
from hjcamp.controllers.schema import controller_schema
from hjcamp.effects import chosen_effects
from hjcamp.errors import UsageError, shown, unknown
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.effect import Effect
from hjcamp.model.language.effect_units import check_units
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.plants.pump_joint.factors import FACTORS
from hjcamp.plants.pump_joint.rig.schema import Backend, Rig
from hjcamp.schema import checked
from hjcamp.trajectories import build_trajectory

GROUPS = (*PumpJoint.settings(), "controller", "trajectory", "backend", "rig", "model")
OWN_EFFECTS = "hjcamp.effects."


def check_test(config: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` for a configuration of this joint with which no test can be made."""
    _check_keys(config)
    PumpJoint.check_settings(config)
    backend = checked(Backend, config["backend"], "backend")
    checked(Rig, config["rig"], "rig")
    check_controller(config["controller"])
    build_trajectory(config["trajectory"])
    effects = chosen_effects(config.get("effects") or {})[0]
    check_model(config["model"], "model", effects)
    if "controller_model" in config:
        check_model(config["controller_model"], "controller.model")
    if "repetitions" in config:
        read_run_keys(config)
    if backend.name == "nidaqmx":
        from hjcamp.plants.pump_joint.rig import reach

        reach.check_test(config)


def check_controller(given: Mapping[str, Any]) -> None:
    """Raise ``UsageError`` for a setting that the chosen control law does not have, and for a value out of bounds."""
    law: Any = find_controller(str(given.get("name")))
    if law.results != Controller.results:
        raise UsageError(
            f"controller {law.name} does not fit plant pump_joint: it gives {', '.join(law.results)}; "
            f"{' and '.join(Controller.results)} of the pump command are needed"
        )
    checked(controller_schema(law), given, "controller")


def check_model(model: Any, path: str, further: Sequence[type[Effect]] = ()) -> None:
    """Raise ``UsageError`` for a model with an unknown effect or parameter, or a value that is not within its bounds.

    ``further`` are the effects of the configuration, which may name the same things.
    """
    if "plant" in model:
        of = shown(model["plant"])
        raise UsageError(f"{path}: '{model.get('name')}' is of plant {of}; this test is of plant pump_joint: write plant={of}")
    checked(SavedModel, model, path)
    effects = {one.name: one for one in (*chosen_effects(model["effects"], f"{path}.effects")[0], *further)}
    for name, value in model["parameters"].items():
        if name not in PumpJoint.parameters:
            raise unknown("parameter", str(name), PumpJoint.parameters, f"{path}.parameters")
        PumpJoint.parameters[name].checked(value, f"{path}.parameters.{name}")
    for name, value in (model.get("factors") or {}).items():
        if name not in FACTORS:
            raise unknown("factor", str(name), FACTORS, f"{path}.factors")
        FACTORS[name].checked(value, f"{path}.factors.{name}")
    # A term of a user's effect may name what the plant does not have.
    Composition(PumpJoint, tuple(effects[name] for name in sorted(effects)))
    for effect in effects.values():
        # Ours are checked by the tests; a user's file may have been saved a moment ago.
        if not effect.__module__.startswith(OWN_EFFECTS):
            check_units(effect, PumpJoint)


def _check_keys(config: Mapping[str, Any]) -> None:
    allowed = (*GROUPS, "effects", "controller_model", "campaign", *RunKeys.model_fields)
    for key in config:
        if key not in allowed:
            raise unknown("group or parameter", str(key), allowed)
    for group in GROUPS:
        if group not in config:
            raise UsageError(f"the group '{group}' is missing; every condition needs a choice of it")
        if not isinstance(config[group], Mapping):
            raise UsageError(f"{group} is {shown(config[group])}; a choice of the group with its parameters is needed")
    if not isinstance(config.get("effects") or {}, Mapping):
        raise UsageError(f"effects is {shown(config['effects'])}; give effects as name: {{parameter: value}}")
