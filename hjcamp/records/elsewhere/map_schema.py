"""The JSON schema of an import's map, for editors that complete and check it as it is written."""

from __future__ import annotations

from typing import Any

from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_table import fields_of
from hjcamp.records.elsewhere.import_map import FIELD_KEYS, GAPS, KEYS, SPIKES
from hjcamp.records.elsewhere.map_values import HIGHEST_SAMPLING_HZ, MOST_SKIPPED
from hjcamp.records.of_plant import LONGEST_PERIOD_S

TEXT: dict[str, Any] = {"type": "string"}
NUMBER: dict[str, Any] = {"type": ["number", "string"]}  # YAML 1.1 reads 1e-3 as a text
YES_OR_NO: dict[str, Any] = {"type": "boolean"}
PERIOD: dict[str, Any] = NUMBER | {"minimum": 1.0 / HIGHEST_SAMPLING_HZ, "maximum": LONGEST_PERIOD_S}
METADATA: dict[str, Any] = {"type": "object", "additionalProperties": {"type": ["string", "number", "boolean", "null"]}}
OF_FIELD: dict[str, dict[str, Any]] = {
    "column": {"type": ["string", "integer"], "description": "what the file calls it"},
    "topic": TEXT | {"description": "of MCAP and ROS 2, where it is not the map's"},
    "unit": {"type": ["string", "number"], "description": "any that pint knows; the field's own where it is absent"},
    "scale": NUMBER, "offset": NUMBER, "unwrap": NUMBER,
    "sign": {"enum": [1, -1]},
}  # fmt: skip
OF_MAP: dict[str, dict[str, Any]] = {
    "plant": TEXT | {"description": "the plant whose logs are made: hjcamp plants"},
    "separator": TEXT, "comment": TEXT, "sheet": TEXT, "group": TEXT, "topic": TEXT,
    "decimal_comma": YES_OR_NO, "header": YES_OR_NO, "units_below": YES_OR_NO,
    "skip_lines": {"type": "integer", "minimum": 0, "maximum": MOST_SKIPPED},
    "period_s": PERIOD, "resample_s": PERIOD,
    "sampling_hz": NUMBER | {"exclusiveMinimum": 0, "maximum": HIGHEST_SAMPLING_HZ},
    "missing": {"description": "what stands for no reading"},
    "gaps": {"enum": list(GAPS)}, "spikes": {"enum": list(SPIKES)},
    "metadata": METADATA,
    "files": {"type": "object", "minProperties": 1, "additionalProperties": METADATA},
}  # fmt: skip


def map_schema(plant: type[Plant] | None = None) -> dict[str, Any]:
    """Return the schema (draft 7) of a map, with the fields of a plant where one is given."""
    rule = {
        "type": "object",
        "additionalProperties": False,
        "required": ["column"],
        "properties": {one: OF_FIELD[one] for one in FIELD_KEYS},
    }
    field = {"anyOf": [rule, {"type": ["string", "integer"]}]}
    fields: dict[str, Any] = {"type": "object", "minProperties": 1}
    if plant is None:
        fields["additionalProperties"] = field
    else:
        table = fields_of(plant).fields
        fields |= {
            "additionalProperties": False,
            "properties": {one.name: field | {"description": f"{one.text} ({one.unit})"} for one in table},
        }
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": f"map of an import{f' of plant {plant.name}' if plant else ''}",
        "type": "object",
        "additionalProperties": False,
        "required": ["fields"],
        "properties": {key: fields if key == "fields" else OF_MAP[key] for key in KEYS},
    }
