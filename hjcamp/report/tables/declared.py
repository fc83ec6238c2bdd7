"""Tables as they are declared in conf/table/*.yaml, and in a user's own folders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from hjcamp.configuration.search_path import group_folders
from hjcamp.errors import UsageError, unknown
from hjcamp.report.runs.indicators import CHOICES, FURTHER, INDICATORS
from hjcamp.yaml_file import read_yaml


@dataclass(frozen=True)
class Column:
    """One column of an arranged table: its title, and the choices that fill it."""

    title: str
    where: Mapping[str, str]


@dataclass(frozen=True)
class Arrows:
    """A comparison shown by arrows: ``of`` one choice of ``group``, ``against`` another."""

    group: str
    of: str
    against: str
    indicators: Sequence[str]


@dataclass(frozen=True, kw_only=True)
class TableDefinition:
    """What conf/table/NAME.yaml says: which tests, which indicators, which rows and columns."""

    name: str
    title: str
    indicators: Sequence[str]
    by: Mapping[str, Sequence[str]]
    source: str = ""
    published: Sequence[str] = ()
    magnitudes: Sequence[str] = ()
    where: Mapping[str, Sequence[str]]
    across: Sequence[Column] = ()
    from_print: Sequence[Column] = ()
    arrows: Arrows | None = None
    improvement_over: str = ""
    only_if_asked: bool = False
    notes: Sequence[str] = ()

    @property
    def keys(self) -> list[str]:
        """The choices that tell the rows of the aggregated frame apart."""
        across = [group for column in self.across for group in column.where]
        return list(dict.fromkeys([*self.by, *across]))


def declared_tables(names: Sequence[str] | None = None) -> list[TableDefinition]:
    """Return the tables of these names, or all that are not made only where asked for.

    `UsageError` for an unknown name and for a definition that does not hold.
    """
    paths: dict[str, Path] = {}
    for folder in group_folders("table"):
        for path in sorted(folder.glob("*.yaml")):
            paths.setdefault(path.stem, path)
    if names is None:
        found = [read_definition(path) for _, path in sorted(paths.items())]
        return [definition for definition in found if not definition.only_if_asked]
    for name in names:
        if name not in paths:
            raise unknown("table", name, paths, "tables")
    return [read_definition(paths[name]) for name in names]


def read_definition(path: Path) -> TableDefinition:
    """Return one definition; `UsageError` names the file, what is wrong and what is allowed."""
    content = _mapping(read_yaml(path), f"{path}")
    _check_keys(content, [field.name for field in fields(TableDefinition) if field.name != "name"], f"{path}")
    for key in ("title", "indicators", "by"):
        if not content.get(key):
            raise UsageError(f"{path}: '{key}' is missing")
    for key in ("indicators", "magnitudes", "published", "across", "from_print", "notes"):
        content[key] = _list(content.get(key, []), f"{path}: {key}")
    for key in ("indicators", "magnitudes"):
        _check_names(content[key], "indicator", (*INDICATORS, *FURTHER), f"{path}: {key}")
    for key in ("by", "where"):
        groups = _mapping(content.get(key, {}), f"{path}: {key}")
        _check_names(groups, "group", (*CHOICES, "campaign"), f"{path}: {key}")
        content[key] = {
            group: [str(name) for name in _list(names, f"{path}: {key}.{group}")] for group, names in groups.items()
        }
    for key in ("across", "from_print"):
        content[key] = [_column(item, f"{path}: {key}") for item in content[key]]
    titles = [column.title for column in content["across"]]
    if content.get("improvement_over", "") not in ("", *titles):
        raise unknown("column", str(content["improvement_over"]), titles, f"{path}: improvement_over")
    if "arrows" in content:
        arrows = _mapping(content["arrows"], f"{path}: arrows")
        _check_keys(arrows, [field.name for field in fields(Arrows)], f"{path}: arrows", all_needed=True)
        _check_names(arrows["indicators"], "indicator", INDICATORS, f"{path}: arrows.indicators")
        content["arrows"] = Arrows(**arrows)
    return TableDefinition(name=path.stem, **content)


def _column(item: object, where: str) -> Column:
    column = _mapping(item, where)
    _check_keys(column, ["title", "where"], where, all_needed=True)
    _check_names(column["where"], "group", CHOICES, where)
    return Column(str(column["title"]), {group: str(name) for group, name in column["where"].items()})


def _mapping(value: object, where: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise UsageError(f"{where} must hold names and values, not {value!r}")
    return dict(value)


def _list(value: object, where: str) -> list[Any]:
    if not isinstance(value, list):
        raise UsageError(f"{where} must be a list, not {value!r}")
    return value


def _check_keys(mapping: Mapping[str, Any], allowed: Sequence[str], where: str, all_needed: bool = False) -> None:
    _check_names(mapping, "key", allowed, where)
    missing = [key for key in allowed if key not in mapping] if all_needed else []
    if missing:
        raise UsageError(f"{where}: '{missing[0]}' is missing")


def _check_names(names: Any, kind: str, allowed: Sequence[str], where: str) -> None:
    for name in names:
        if name not in allowed:
            raise unknown(kind, str(name), allowed, where)
