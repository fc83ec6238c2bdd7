"""The JSON schemas of the files that users write, made of the models that check them, for editors that complete and check."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from hjcamp.configuration.composer import Composer
from hjcamp.configuration.file_models import CampaignFile, SavedModel
from hjcamp.configuration.plant_settings import GROUPS, VALUES
from hjcamp.configuration.run_keys import RunKeys
from hjcamp.effects import load_effects
from hjcamp.errors import unknown
from hjcamp.known_plants import DEFAULT, usual_plant
from hjcamp.model.declare.plant import Plant
from hjcamp.schema import Group

DRAFT = "https://json-schema.org/draft/2020-12/schema"
PART = "_of_a_part"
#: What may stand at the top of any configuration besides its groups.
TOP = (*VALUES, "effects", "controller_model")
KINDS = ("map", "campaign", "rig", "model", "settings")


def names() -> list[str]:
    """Return what `file_schema` knows: the kinds of files, and the groups that have a file for each choice."""
    return [*KINDS, *usual_plant().settings()]


def file_schema(name: str, plant: type[Plant] | None = None) -> dict[str, Any]:
    """Return the schema of a kind of file, with the names that a plant has; raises UsageError for one that there is not."""
    groups: dict[str, type[Group]] = {**usual_plant().settings(), "rig": _rig()}
    made: dict[str, Callable[[], dict[str, Any]]] = {
        "map": lambda: _map(plant),
        "campaign": lambda: campaign_schema(plant or usual_plant()),
        "model": lambda: model_schema(plant),
        "settings": settings_schema,
    }
    if name in groups:
        return choice_schema(groups[name], name)
    if name not in made:
        raise unknown("file", name, names())
    return made[name]()


def choice_schema(model: type[Group], group: str) -> dict[str, Any]:
    """Return the schema of ``GROUP/NAME.yaml``.

    One that begins from ``defaults`` may leave out what these give, any number may be interpolated (``${...}``), and a file with
    ``# @package _global_`` holds the group under its name, with effects next to it.
    """
    found = model.model_json_schema()
    defs = found.pop("$defs", {})
    parts = {name: _written(one, False) for name, one in defs.items()}
    parts |= {name + PART: _written(one, True) for name, one in defs.items()}
    parts |= {"whole": _written(found, False), "part": _written(found, True)}
    parts["part"]["properties"]["defaults"] = {"type": "array"}
    in_package = {"type": "object", "additionalProperties": False, "required": [group]}
    in_package["properties"] = {group: {"$ref": "#/$defs/whole"}, "effects": {"type": "object"}, "defaults": {"type": "array"}}
    begun = {"if": {"required": ["defaults"]}, "then": {"$ref": "#/$defs/part"}, "else": {"$ref": "#/$defs/whole"}}
    return _headed(f"a choice of {group}", {"$defs": parts, "if": {"required": [group]}, "then": in_package, "else": begun})


def settings_schema() -> dict[str, Any]:
    """Return the schema of a resolved configuration of the usual plant, as ``config.yaml`` of a run holds it."""
    models: dict[str, type[Group]] = {**usual_plant().settings(), "rig": _rig(), "model": SavedModel}
    defs: dict[str, Any] = {}
    properties: dict[str, Any] = {}
    for group, model in models.items():
        properties[group] = model.model_json_schema(ref_template="#/$defs/{model}")
        defs |= properties[group].pop("$defs", {})
    keys = RunKeys.model_json_schema()["properties"]
    others = {one: {"type": ["object", "null"]} for one in ("controller", "trajectory", "backend", "plant", "campaign", *TOP)}
    return _headed(
        "a resolved configuration",
        {
            "$defs": defs,
            "type": "object",
            "additionalProperties": False,
            "properties": others | properties | keys,
        },
    )


def campaign_schema(plant: type[Plant]) -> dict[str, Any]:
    """Return the schema of a campaign file: its keys, and the groups, choices and parameters of a plant that it may set."""
    composer = Composer()
    groups = [*GROUPS, "rig"] if plant.name != DEFAULT else [one for one in composer.groups() if one != "campaign"]
    choices: dict[str, Any] = {one: {"enum": composer.options(one)} for one in groups if composer.options(one)}
    choices["plant"] = {"enum": [plant.name, *([None] if plant.name == DEFAULT else [])]}
    value: dict[str, Any] = {"not": {"type": "null"}}
    dotted = "|".join(dict.fromkeys([*groups, *TOP]))
    settings = {
        "type": "object",
        "properties": choices,
        "patternProperties": {rf"^[+~]?({dotted})[.@/].+$": {}, r"^\+?(parameters|start|effects)$": {"type": "object"}},
        "additionalProperties": False,
    }
    case = {"type": "object", "additionalProperties": {"$ref": "#/$defs/settings"}, "minProperties": 1}
    listed = {
        **{one: {"anyOf": [{"type": "array", "items": known, "minItems": 1}, case]} for one, known in choices.items()},
    }
    found = CampaignFile.model_json_schema()
    found["properties"]["fixed"] = {"$ref": "#/$defs/settings"}
    found["properties"]["vary"] = {
        "type": "object",
        "minProperties": 1,
        "properties": listed,
        "patternProperties": {r"[.@/]": {"anyOf": [{"type": "array", "items": value, "minItems": 1}, case]}},
        "additionalProperties": case,
    }
    found["required"] = ["vary"]
    return _headed(f"a campaign of plant {plant.name}", found | {"$defs": {"settings": settings}})


def model_schema(plant: type[Plant] | None) -> dict[str, Any]:
    """Return the schema of ``model/NAME.yaml``, with the parameters and effects of a plant where one is given."""
    found = SavedModel.model_json_schema()
    found["properties"] |= {"defaults": {"type": "array"}}
    if plant is not None:
        number = {"type": ["number", "string"]}  # YAML 1.1 reads 1e-3 as a text
        parameters = {name: number | {"description": f"{one.text} ({one.unit})"} for name, one in plant.parameters.items()}
        effects = {
            name: {
                "type": ["object", "null"],
                "additionalProperties": False,
                "properties": {
                    one: number | {"description": f"{item.text} ({item.unit})"} for one, item in effect.parameters.items()
                },
            }
            for name, effect in load_effects(plant=plant).items()
        }
        closed = {"type": "object", "additionalProperties": False}
        found["properties"]["parameters"] = closed | {"properties": parameters}
        found["properties"]["effects"] = closed | {"properties": effects}
    return _headed("a model", found)


def _map(plant: type[Plant] | None) -> dict[str, Any]:
    from hjcamp.records.elsewhere.map_schema import map_schema

    return map_schema(plant)


def _rig() -> type[Group]:
    model: type[Group] = usual_plant().own_room("configuration").Rig
    return model


def _headed(title: str, content: Mapping[str, Any]) -> dict[str, Any]:
    return {"$schema": DRAFT, **content, "title": title}


def _written(schema: Any, part: bool) -> Any:
    """Return a schema as files are written: numbers and switches may be interpolated; a ``part`` requires nothing."""
    if isinstance(schema, list):
        return [_written(one, part) for one in schema]
    if not isinstance(schema, dict):
        return schema
    found = {key: _written(value, part) for key, value in schema.items() if not (part and key == "required")}
    if part and "$ref" in found:
        found["$ref"] += PART
    if found.get("type") in ("number", "integer", "boolean"):
        return {"anyOf": [found, {"type": "string", "pattern": r"\$\{"}]}
    return found
