"""The mapping file of an import: which column of a table is which field of a test log."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.records.check import check_names
from hjcamp.records.log import FIELD_NAMES, FIELDS
from hjcamp.records.plausible import PLANT
from hjcamp.records.units import factor_to_field
from hjcamp.yaml_file import read_yaml

LOWEST_SAMPLING_HZ = 200.0
HIGHEST_SAMPLING_HZ = 100e3
KEYS = ("separator", "decimal_comma", "skip_lines", "comment", "sampling_hz", "fields", "metadata")
FIELD_KEYS = ("column", "unit", "scale", "offset", "sign")


@dataclass(frozen=True)
class ColumnRule:
    """``field = sign * (scale * column + offset) * factor``, the factor being that of the unit."""

    column: str
    scale: float = 1.0
    offset: float = 0.0
    sign: float = 1.0
    factor: float = 1.0


@dataclass(frozen=True)
class ImportMap:
    """What a mapping file says; ``sampling_hz`` may be None where ``time_s`` is mapped."""

    rules: dict[str, ColumnRule]
    metadata: dict[str, str]
    sampling_hz: float | None
    separator: str = ","
    decimal_comma: bool = False
    skip_lines: int = 0
    comment: str | None = None


def read_import_map(path: Path) -> ImportMap:
    """Return the mapping in a YAML file; raises UsageError for every key, field, unit or number that cannot be."""
    where = str(path)
    content = read_yaml(path)
    _only_known(content, KEYS, "key", where)
    fields = content.get("fields")
    _only_known(fields, FIELD_NAMES, "field", f"{where} (a log of plant {PLANT.name})")
    rules = {name: _rule(name, fields[name], where) for name in FIELD_NAMES if name in fields}
    sampling_hz = content.get("sampling_hz")
    if sampling_hz is not None:
        sampling_hz = _number(sampling_hz, "sampling_hz", where)
        if sampling_hz < LOWEST_SAMPLING_HZ:
            raise UsageError(
                f"{where}: sampling_hz is {sampling_hz:g}; below {LOWEST_SAMPLING_HZ:g} Hz too little is left of a test"
            )
        if sampling_hz > HIGHEST_SAMPLING_HZ:
            raise UsageError(f"{where}: sampling_hz is {sampling_hz:g}; at most {HIGHEST_SAMPLING_HZ:g} Hz")
    elif "time_s" not in rules:
        raise UsageError(f"{where}: give sampling_hz, or map a column to time_s")
    check_names({"time_s", *rules}, where)
    metadata = content.get("metadata") or {}
    if not isinstance(metadata, Mapping) or any(isinstance(value, dict | list) for value in metadata.values()):
        raise UsageError(f"{where}: metadata must be names with one value each")
    return ImportMap(
        rules=rules,
        metadata={str(key): str(value) for key, value in metadata.items() if value is not None},
        sampling_hz=sampling_hz,
        separator=_separator(content.get("separator", ","), where),
        decimal_comma=content.get("decimal_comma") is True,
        skip_lines=max(0, int(_number(content.get("skip_lines", 0), "skip_lines", where))),
        comment=str(content["comment"]) if content.get("comment") else None,
    )


def _rule(name: str, content: Any, where: str) -> ColumnRule:
    place = f"'{name}' of {where}"
    if isinstance(content, str):
        content = {"column": content}
    _only_known(content, FIELD_KEYS, "key", place)
    if "column" not in content:
        raise UsageError(f"{place}: give the column that holds it")
    own_unit = next(field.unit for field in FIELDS if field.name == name)
    numbers = {key: _number(content[key], key, place) for key in ("scale", "offset", "sign") if key in content}
    if numbers.get("sign", 1.0) not in (1.0, -1.0):
        raise UsageError(f"{place}: sign is {numbers['sign']:g}; allowed: 1, -1")
    if numbers.get("scale", 1.0) == 0.0:
        raise UsageError(f"{place}: a scale of 0 leaves nothing of the column")
    factor = factor_to_field(name, str(content.get("unit", own_unit)), where)
    return ColumnRule(column=str(content["column"]), factor=factor, **numbers)


def _only_known(content: Any, allowed: tuple[str, ...], kind: str, where: str) -> None:
    if not isinstance(content, Mapping) or not content:
        raise UsageError(f"{where}: expected a mapping with the {kind}s {', '.join(allowed)}")
    for name in content:
        if name not in allowed:
            raise unknown(kind, str(name), allowed, where)


def _number(value: Any, name: str, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise UsageError(f"{where}: {name} is {value!r}, not a finite number")
    return float(value)


def _separator(value: Any, where: str) -> str:
    if not isinstance(value, str) or len(value.encode()) != 1:
        raise UsageError(f"{where}: separator is {value!r}; give one character, such as ',' or ';' or \"\\t\"")
    return value
