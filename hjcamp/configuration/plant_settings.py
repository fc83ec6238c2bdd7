"""What the configuration of a test of another plant than the usual one begins with, and its check."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field

from hjcamp.backends.plant_simulation import followed_unit, law_of, model_of, plant_in
from hjcamp.backends.schedule import schedule_of
from hjcamp.configuration.file_models import SavedModel
from hjcamp.controllers import find_controller, load_controllers
from hjcamp.controllers.controller import Controller
from hjcamp.controllers.fit import check_fits, commanded, fitting
from hjcamp.controllers.schema import controller_schema
from hjcamp.effects import chosen_effects
from hjcamp.errors import UsageError, shown, unknown
from hjcamp.known_plants import DEFAULT, find_plant, usual_plant
from hjcamp.model.compile.compose import Composition
from hjcamp.model.declare.base_values import checked_base, period_of
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.user_file import is_users
from hjcamp.model.language.effect_units import check_units
from hjcamp.rigs import SHIPPED
from hjcamp.schema import Group, between, checked
from hjcamp.trajectories import build_trajectory

USUAL = {"controller": "given", "procedure": "at_once", "trajectory": "hold"}
#: The groups that describe the usual plant's hardware and its rig: another plant has none of them.
ABSENT = (*(group for group in usual_plant().settings() if group != "procedure"), "rig")
GROUPS = ("plant", "controller", "trajectory", "procedure", "backend", "model")
VALUES = ("parameters", "start")
BACKENDS = ("simulation", "rig")


class PlantGroup(Group):
    """The plant and how its tests differ: ``scatter`` and ``noise`` are factors on what the plant declares."""

    name: str
    scatter: float = between(0.0, 10.0)
    noise: float = between(0.0, 100.0)


class PlantRig(Group):
    """The choice of a rig: whether it must have passed its check, and what stops its drives where it has no watchdog."""

    name: str
    check_required: bool
    interlock: str | None


class PlantProcedure(Group):
    """What is around the command phase: rest before and after it, with no command, or that of the phase before.

    ``phases`` changes what the plant declares: for each by its name ``seconds``, and where inputs go.
    """

    name: str
    rest_ms: float = between(0.0, 600_000.0)
    after_ms: float = between(0.0, 600_000.0)
    phases: dict[str, Any] = Field(default={})


def plant_settings(name: str) -> dict[str, Any]:
    """Return what the choice ``plant=NAME`` sets: no hardware of the usual plant, and the plant's own choices of groups."""
    if name == DEFAULT:
        return {}
    plant = find_plant(name)
    for group in plant.choices:
        if group not in USUAL:
            raise unknown("group", group, USUAL, f"plant {name}, choices")
    chosen: dict[str, Any] = dict.fromkeys(ABSENT) | USUAL | dict(plant.choices)
    return {
        "defaults": [*({f"override /{group}": choice} for group, choice in chosen.items()), "_self_"],
        "plant": {"name": name, "scatter": 1.0, "noise": 1.0},
        "parameters": {},
        "start": {},
    }


def rig_settings(name: str) -> dict[str, Any]:
    """Return what the choice ``rig=NAME`` of another plant than the usual one sets; what else there is stands in the rig's file."""
    return {"name": name, "check_required": True, "interlock": None}


def rig_of_plant(given: Mapping[str, Any], plant: str) -> dict[str, Any]:
    """Return the group ``rig`` of another plant's test: of a choice that the usual plant has too, what is of any plant."""
    known = rig_settings("")
    if given.get("name") not in SHIPPED and not set(given) <= set(known):
        raise UsageError(
            f"rig '{given.get('name')}' wires plant {DEFAULT}; plant {plant} needs a file rigs/NAME.py: hjcamp rigs new NAME"
        )
    return {key: given[key] for key in given if key in known}


def check_plant_configuration(config: Mapping[str, Any], further_keys: tuple[str, ...]) -> None:
    """Raise ``UsageError`` for a configuration of a plant with which no test can be made."""
    for key in config:
        if key not in (*GROUPS, *VALUES, "rig", "effects", "controller_model", *further_keys):
            if key in ABSENT:
                raise UsageError(f"plant {config['plant'].get('name')}: it has no group '{key}', which belongs to {DEFAULT}")
            raise unknown("group or parameter", str(key), (*GROUPS, *VALUES, "effects"))
    for group in GROUPS:
        if not isinstance(config.get(group), Mapping):
            raise UsageError(f"{group} is {shown(config.get(group))}; a choice of the group with its parameters is needed")
    checked(PlantGroup, config["plant"], "plant")
    checked(SavedModel, config["model"], "model")
    plant = plant_in(config)
    backend = config["backend"].get("name")
    if backend not in BACKENDS:
        raise UsageError(
            f"plant {plant.name}: backend '{backend}' has no wiring of it; use backend=simulation, or backend=rig rig=NAME"
        )
    checked(PlantProcedure, config["procedure"], "procedure")
    check_plant_controller(config["controller"], plant)
    law, chosen = law_of(config)
    schedule_of(config, plant, list(commanded(law, plant, chosen)), 1)
    _, unit = followed_unit(config, plant)
    build_trajectory(config["trajectory"], unit=unit)
    check_values(config, plant)
    if backend == "rig":
        _check_rig(config, plant)


def _check_rig(config: Mapping[str, Any], plant: type[Plant]) -> None:
    """Raise ``UsageError`` for a rig that is none, is of another plant, or does not reach what the test needs."""
    from hjcamp.backends.rig.any_plant import backend

    if not isinstance(config.get("rig"), Mapping):
        raise UsageError(
            f"plant {plant.name}: backend=rig needs a rig: rig=NAME of rigs/NAME.py, or one of {', '.join(SHIPPED)}"
        )
    checked(PlantRig, config["rig"], "rig")
    backend.check_test(config)


def check_plant_controller(given: Mapping[str, Any], plant: type[Plant]) -> None:
    """Raise ``UsageError`` for a controller that does not fit the plant, with the reason and those that do."""
    law: Any = find_controller(str(given.get("name")))
    _check_fits(law, plant, str(given.get("input") or ""))
    checked(controller_schema(law), given, "controller")


def refuse_unfit(controller: str, plant: str) -> None:
    """Raise ``UsageError`` where a controller cannot fit a plant, whatever its configuration says."""
    law, chosen = load_controllers().get(controller), find_plant(plant)
    if law is not None and plant != DEFAULT:
        _check_fits(law, chosen, next(iter(chosen.given_inputs()), ""))


def _check_fits(law: type[Controller], plant: type[Plant], chosen: str) -> None:
    try:
        check_fits(law, plant, chosen)
    except UsageError as problem:
        allowed = ", ".join(fitting(load_controllers(), plant))
        raise UsageError(f"{problem}. Controllers that fit {plant.name}: {allowed}") from None


def check_values(config: Mapping[str, Any], plant: type[Plant]) -> None:
    """Raise ``UsageError`` for parameters, a start or effects that the plant cannot have."""
    model = config["model"]
    for path, values in (("parameters", config.get("parameters")), ("model.parameters", model.get("parameters"))):
        checked_base(values, plant, path)
    for name, value in (config.get("start") or {}).items():
        if name not in plant.states:
            raise unknown("state", str(name), plant.states, f"start of plant {plant.name}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise UsageError(f"start.{name} is {shown(value)}; a number in {plant.states[name].unit} is needed")
    if model.get("plant", plant.name) != plant.name:
        raise UsageError(f"model '{model.get('name')}' is of plant {shown(model['plant'])}; this test is of plant {plant.name}")
    period = period_of(model, "model")
    for path, given in (("effects", config.get("effects")), ("model.effects", model.get("effects"))):
        if not isinstance(given or {}, Mapping):
            raise UsageError(f"{path} is {shown(given)}; give effects as name: {{parameter: value}}")
        chosen_effects(given or {}, path, plant, period)
    effects, _ = model_of(config, plant)
    Composition(plant, tuple(effects))
    for effect in effects:
        if is_users(effect.__module__):
            check_units(effect, plant)
