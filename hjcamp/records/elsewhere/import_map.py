"""The mapping file of an import: which column of a table is which field of a plant's logs."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.known_plants import DEFAULT, find_plant, plants_and_faults
from hjcamp.model.checks.plant_checks import check_users_plant
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.declare.plant import Plant
from hjcamp.model.language.field_table import FieldTable, fields_of
from hjcamp.model.language.field_unit import field_of, unit_of_field
from hjcamp.records.check import check_names
from hjcamp.records.elsewhere.map_values import (
    interpolates,
    lines_of,
    missing_of,
    number_of,
    only_known,
    period_of_rows,
    resample_of,
    separator_of,
    yes_or_no,
)
from hjcamp.records.of_plant import PERIOD_KEY, PLANT_KEY
from hjcamp.records.units import conversion_to_field
from hjcamp.yaml_file import read_yaml

KEYS = (
    "plant", "separator", "decimal_comma", "header", "units_below", "skip_lines", "comment", "sheet", "group", "topic", "period_s",
    "sampling_hz", "resample_s", "missing", "gaps", "spikes", "fields", "metadata", "files",
)  # fmt: skip
FIELD_KEYS = ("column", "topic", "unit", "scale", "offset", "sign", "unwrap")
GAPS = ("refuse", "interpolate")
SPIKES = ("keep", "interpolate")
FILE_WORD = "{file}"
OPEN = "?"  # what a guessed map leaves to be answered
# What YAML reads as something else than the name that stands there.
READ_OTHERWISE = re.compile(r"[\[\]{}\"'#&*!|>%@`]|:\s.*:\s")


@dataclass(frozen=True)
class ColumnRule:
    """``field = (sign * (scale * column + offset) + shift) * factor``: shift and factor are those of the unit.

    A column that begins again after ``unwrap``, in its own unit, goes on. ``topic``: of an MCAP file, where it is not the map's.
    """

    column: str
    scale: float = 1.0
    offset: float = 0.0
    sign: float = 1.0
    shift: float = 0.0
    factor: float = 1.0
    unwrap: float | None = None
    topic: str = ""

    @property
    def key(self) -> str:
        """The column's name among those of the whole file."""
        return f"{self.topic}:{self.column}" if self.topic else self.column

    def field_of(self, values: np.ndarray) -> np.ndarray:
        """Return the field of a column (rows,); what overflows is not finite."""
        if (self.scale, self.offset, self.sign, self.shift, self.factor) == (1.0, 0.0, 1.0, 0.0, 1.0):
            return values
        with np.errstate(over="ignore", invalid="ignore"):
            return (self.sign * (self.scale * values + self.offset) + self.shift) * self.factor


@dataclass(frozen=True)
class ImportMap:
    """What a mapping file says; ``period`` (s) may be None where ``time_s`` is mapped or the file has times.

    ``by_rate`` where it stands there as ``sampling_hz``; ``files`` are the metadata of single files.
    """

    plant: type[Plant]
    table: FieldTable
    rules: dict[str, ColumnRule]
    metadata: dict[str, str]
    period: float | None
    by_rate: bool
    where: str
    resample: float | None = None  # s between samples that uneven rows are brought to
    interpolate: bool = False  # cells without a value
    without_spikes: bool = False  # readings that jump out and back
    missing: tuple[float | str, ...] = ()  # readings that stand for none
    files: dict[str, dict[str, str]] = field(default_factory=dict)
    topic: str = ""
    sheet: str = ""
    group: str = ""
    separator: str | None = None
    decimal_comma: bool | None = None
    header: bool | None = None
    units_below: bool = False  # the line below the header holds units
    skip_lines: int = 0
    comment: str | None = None

    def metadata_for(self, file: Path) -> dict[str, str]:
        """Return the metadata of one file.

        Raises UsageError where ``files`` does not know it, and for a value that a parameter of the plant cannot have.
        """
        own: dict[str, str] = {}
        if self.files:
            name = file.name if file.name in self.files else file.stem
            if name not in self.files:
                raise unknown("file", file.name, self.files, f"the files of {self.where}")
            own = self.files[name]
        found = {key: value.replace(FILE_WORD, file.stem) for key, value in (self.metadata | own).items()}
        for item in self.plant.parameters.values():
            if item.given and item.given in found:
                _given_value(found[item.given], item.given, item.unit, item.bounds, f"{file} by {self.where}")
        return found

    def lacking(self, tests: Iterable[Mapping[str, str]]) -> list[str]:
        """Return what the plant expects in the metadata of each of ``tests`` and some of them do not say."""
        given = dict.fromkeys(item.given for item in self.plant.parameters.values() if item.given)
        known = list(tests)
        return [name for name in given if any(name not in metadata for metadata in known)]

    @property
    def held(self) -> list[str]:
        """The fields that keep their value between rows: inputs that hold it, and the phase."""
        given = self.plant.given_inputs().values()
        return [*(one.field or field_of(one.name, one.unit, self.where) for one in given if one.hold == "previous"), "phase"]

    @property
    def taken_twice(self) -> dict[str, list[str]]:
        """The columns of which several fields are made, with these; what is wanted may well be the column of what is given."""
        found: dict[str, list[str]] = {}
        for name, rule in self.rules.items():
            if not name.startswith("reference_"):
                found.setdefault(rule.key, []).append(name)
        return {column: names for column, names in found.items() if len(names) > 1}


def read_import_map(path: Path) -> ImportMap:
    """Return the mapping in a YAML file; raises UsageError for every key, field, unit or number that cannot be."""
    where = str(path)
    content = _content(path)
    only_known(content, KEYS, "key", where)
    _refuse_open(content, where)
    plant = find_plant(_text(content, "plant", where) or DEFAULT, where)
    check_users_plant(plant)
    table = fields_of(plant)
    fields = content.get("fields")
    _only_fields(fields, table, where)
    rules = {name: _rule(name, fields[name], table, where) for name in table.names if name in fields}
    topic = _text(content, "topic", where)
    period = period_of_rows(content, plant, where)
    check_names({"time_s", *rules}, table, where)
    metadata = _metadata(content.get("metadata"), "metadata", where)
    return ImportMap(
        plant=plant,
        table=table,
        rules=rules,
        metadata=metadata,
        period=period,
        by_rate="sampling_hz" in content,
        where=where,
        resample=resample_of(content["resample_s"], plant, where) if "resample_s" in content else None,
        interpolate=interpolates(content, "gaps", GAPS, where),
        without_spikes=interpolates(content, "spikes", SPIKES, where),
        files=_files(content.get("files"), where),
        topic=topic,
        sheet=_text(content, "sheet", where),
        group=_text(content, "group", where),
        separator=separator_of(content["separator"], where) if "separator" in content else None,
        decimal_comma=yes_or_no(content["decimal_comma"], "decimal_comma", where) if "decimal_comma" in content else None,
        header=yes_or_no(content["header"], "header", where) if "header" in content else None,
        units_below=yes_or_no(content.get("units_below", False), "units_below", where),
        missing=missing_of(content["missing"], where) if "missing" in content else (),
        skip_lines=lines_of(content.get("skip_lines", 0), where),
        comment=str(content["comment"]) if content.get("comment") else None,
    )


def _content(path: Path) -> Any:
    """Return what a mapping file holds; where it is no YAML, the refusal says which names are to be quoted."""
    try:
        return read_yaml(path)
    except UsageError as fault:
        at = re.search(r", line (\d+)$", str(fault))
        lines = path.read_text(errors="replace").splitlines()[: int(at[1])][-2:] if at else []
        names = [line.partition(":")[2] for line in lines]
        if not any(READ_OTHERWISE.search(name.strip().removeprefix("{").removesuffix("}")) for name in names):
            raise
        raise UsageError(
            f'{fault}; a name with brackets, braces, a colon, # or quotes is written in quotes: "Time [s]"'
        ) from None


def example_map(plant: type[Plant]) -> str:
    """Return a mapping file for a plant whose columns are called as its fields are; what a log may lack is a comment."""
    table = fields_of(plant)
    lines = [f"plant: {plant.name}", "# period_s: 0.001   instead of time_s, or sampling_hz", "fields:"]
    for known in table.fields:
        needed = known.required or known.name in table.one_of[:1]
        meaning = known.text + (f" (one of {', '.join(table.one_of)})" if known.name in table.one_of else "")
        text = f"  {'' if needed else '# '}{known.name}: {{column: {known.name}, unit: {_quoted(known.unit)}}}"
        lines.append(f"{text}  # {meaning}" if meaning else text)
    lines += [
        "# scale, offset and sign in addition to unit: sign * (scale * column + offset)",
        "metadata:",
        '  condition: "{file}"',
    ]
    given = {item.given: item for item in plant.parameters.values() if item.given}
    for name, item in given.items():
        lines.append(f"  {name}: {_example_value(name, item):g}  # {item.text or item.name}")
    return "\n".join(lines)


def _quoted(unit: str) -> str:
    return f'"{unit}"' if unit in ("1", "%") else unit


def _example_value(name: str, item: Parameter) -> float:
    return item.default * _scale_of(name, item.unit)[0]


def _refuse_open(content: Mapping[str, Any], where: str) -> None:
    """Raise UsageError where a guessed map still has a question mark; it says where all of them are."""
    fields = content.get("fields")
    places = [key for key, value in content.items() if value == OPEN]
    for name, rule in fields.items() if isinstance(fields, Mapping) else ():
        places += [f"{key} of {name}" for key, value in rule.items() if value == OPEN] if isinstance(rule, Mapping) else []
    if places:
        raise UsageError(
            f"{where}: still open: {', '.join(map(str, places))}; write what stands for '{OPEN}', or delete the line"
        )


def _text(content: Mapping[str, Any], key: str, where: str) -> str:
    value = content.get(key)
    if value is not None and not isinstance(value, str):
        raise UsageError(f"{where}: {key} is {shown(value)}; a name is needed")
    return value or ""


def _only_fields(fields: Any, table: FieldTable, where: str) -> None:
    """Raise UsageError for a field that the plant's logs have not; it says of which plant it is, where one has it."""
    here = f"{where} (a log of plant {table.plant})"
    try:
        only_known(fields, table.names, "field", here)
    except UsageError as refusal:
        strange = [str(name) for name in fields or {} if name not in table.names] if isinstance(fields, Mapping) else []
        others = _plants_with(strange[0]) if strange else []
        if not others:
            raise
        several = " and ".join(others)
        raise UsageError(f"{refusal}; '{strange[0]}' is a field of plant {several}: write plant: {others[0]}") from None


def _plants_with(name: str) -> list[str]:
    found = []
    for plant in plants_and_faults()[0].values():
        with suppress(UsageError):  # another plant's file may be at fault; that is not what is asked
            if name in fields_of(plant).names and name not in ("time_s", "phase"):
                found.append(plant.name)
    return found


def _rule(name: str, content: Any, table: FieldTable, where: str) -> ColumnRule:
    place = f"'{name}' of {where}"
    if isinstance(content, str) or (isinstance(content, int) and not isinstance(content, bool)):
        content = {"column": content}
    only_known(content, FIELD_KEYS, "key", place)
    column = content.get("column")
    if column is not None and (isinstance(column, bool) or not isinstance(column, str | int)):
        raise UsageError(f"{place}: YAML reads this column as {shown(column)}; write its name in quotes")
    if column is None:
        raise UsageError(f"{place}: give the column that holds it")
    numbers = {key: number_of(content[key], key, place) for key in ("scale", "offset", "sign", "unwrap") if key in content}
    if numbers.get("sign", 1.0) not in (1.0, -1.0):
        raise UsageError(f"{place}: sign is {numbers['sign']:g}; allowed: 1, -1")
    if numbers.get("scale", 1.0) == 0.0:
        raise UsageError(f"{place}: a scale of 0 leaves nothing of the column")
    if numbers.get("unwrap", 1.0) <= 0.0:
        raise UsageError(
            f"{place}: unwrap is {numbers['unwrap']:g}; give after how much the column begins again, such as 65536 or 360"
        )
    known = table.field(name)
    unit = conversion_to_field(known, str(content.get("unit", known.unit)), where)
    return ColumnRule(column=str(column), topic=_text(content, "topic", place), shift=unit.shift, factor=unit.factor, **numbers)


def _metadata(content: Any, place: str, where: str) -> dict[str, str]:
    content = content or {}
    if not isinstance(content, Mapping) or any(isinstance(value, dict | list) for value in content.values()):
        raise UsageError(f"{where}: {place} must be names with one value each")
    found = {str(key): str(value) for key, value in content.items() if value is not None}
    for key in (PLANT_KEY, PERIOD_KEY):
        if key in found:
            raise UsageError(f"{where}: {place}: {key} is written by the import; give it next to fields, as '{key}: ...'")
    return found


def _given_value(text: str, name: str, si: str, bounds: tuple[float, float], place: str) -> None:
    """Raise UsageError where what a test is said to have (a mass, a supply) is no number within its bounds."""
    scale, unit = _scale_of(name, si)
    try:
        value = float(text) / scale
    except ValueError:
        value = math.nan
    if not bounds[0] <= value <= bounds[1]:
        low, high = (end * scale for end in bounds)
        raise UsageError(f"{place}: {name} is {text!r:.40}; a number from {low:g} to {high:g} {unit} is needed")


def _scale_of(name: str, si: str) -> tuple[float, str]:
    """Return the unit that the end of a name says, with its number for one SI unit; the SI unit where it says none."""
    with suppress(UsageError):
        if (known := unit_of_field(name, name)).si == si:
            return known.scale, known.shown
    return 1.0, si


def _files(content: Any, where: str) -> dict[str, dict[str, str]]:
    if content is None:
        return {}
    if not isinstance(content, Mapping) or not content:
        raise UsageError(f"{where}: files must be file names, each with its metadata: FILE: {{condition: ...}}")
    return {str(name): _metadata(one, f"files: {name}", where) for name, one in content.items()}
