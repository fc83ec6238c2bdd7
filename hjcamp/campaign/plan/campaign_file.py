"""A campaign file: which choices are fixed, which vary, how often, which tables; read and checked."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from hjcamp.configuration.file_models import CampaignFile
from hjcamp.configuration.run_keys import RunKeys
from hjcamp.errors import UsageError, unknown
from hjcamp.schema import checked

KEYS = tuple(CampaignFile.model_fields)
RUN_KEYS = ("campaign", "hydra", *RunKeys.model_fields)


@dataclass(frozen=True)
class Axis:
    """One thing that varies: ``cases`` maps a label to the settings ``{group or parameter: value}`` it stands for."""

    name: str
    cases: dict[str, dict[str, Any]]

    @property
    def keys(self) -> set[str]:
        """The groups and parameters that any case sets."""
        return {key for settings in self.cases.values() for key in settings}


@dataclass(frozen=True)
class Campaign:
    """A checked campaign. The conditions are the product of ``axes``, the last varying fastest."""

    name: str
    description: str
    fixed: dict[str, Any]
    axes: tuple[Axis, ...]


def read_campaign(content: Mapping[str, Any], expected_name: str) -> Campaign:
    """Return the campaign that the file ``expected_name.yaml`` describes.

    Raises ``UsageError`` for unknown keys, a name that differs from the file's, a campaign that varies nothing, and
    one that sets or varies the same thing twice.
    """
    where = f"campaign '{expected_name}'"
    for key in content:
        if key not in KEYS:
            raise unknown("key", str(key), KEYS, where)
    if content.get("name", expected_name) != expected_name:
        raise UsageError(f"{where}: its key 'name' is '{content['name']}'; it must be the name of its file")
    fixed = _settings(content.get("fixed") or {}, f"{where}, fixed")
    vary = content.get("vary")
    if not isinstance(vary, Mapping) or not vary:
        raise UsageError(f"{where} varies nothing; write at least one axis, for example  vary: {{controller: [pid]}}")
    axes = tuple(_axis(str(name), values, where) for name, values in vary.items())
    for axis in axes:
        for key in sorted(axis.keys & set(fixed)):
            raise UsageError(f"{where} sets '{key}' twice: in 'fixed' and in the axis '{axis.name}'")
    for one, other in combinations(axes, 2):
        for key in sorted(one.keys & other.keys):
            raise UsageError(f"{where} varies '{key}' twice: in the axes '{one.name}' and '{other.name}'")
    checked(CampaignFile, content, where)
    return Campaign(expected_name, str(content.get("description") or ""), fixed, axes)


def label_of(key: str, value: Any) -> str:
    """Return a short name of one value of an axis: the choice, or ``kp=1.05`` for a parameter."""
    parameter, text = "" if isinstance(value, str) else f"{key.split('.')[-1]}=", str(value).replace("e+", "e")
    safe = "".join(letter if (letter.isalnum() and letter.isascii()) or letter in "._-" else "-" for letter in text)
    return parameter + (safe.strip(".") or "empty")


def _axis(name: str, values: Any, where: str) -> Axis:
    place = f"{where}, axis '{name}'"
    if isinstance(values, Mapping):
        cases = {label_of("", str(label)): _settings(bundle, f"{place}, case '{label}'") for label, bundle in values.items()}
        count = len(values)
    elif isinstance(values, list | tuple):
        # A list holds values of the one group or parameter that the axis is named after.
        _refuse_run_key(name, place)
        cases = {label_of(name, value): {name: value} for value in values}
        count = len(values)
    else:
        raise UsageError(f"{place} is {values!r}; a list of values or a mapping of cases is needed")
    if not count:
        raise UsageError(f"{place} is empty: the campaign varies nothing there")
    for one, other in combinations(cases, 2):
        if cases[one] == cases[other]:
            raise UsageError(f"{place} varies the same thing twice: '{one}' and '{other}' have equal settings")
    if len(cases) < count:
        raise UsageError(f"{place} varies the same thing twice: {', '.join(map(str, values))}")
    return Axis(name, cases)


def _settings(content: Any, place: str) -> dict[str, Any]:
    if not isinstance(content, Mapping):
        raise UsageError(f"{place} is {content!r}; a mapping of groups and parameters to values is needed")
    settings = {str(key): value for key, value in content.items()}
    for key, value in settings.items():
        _refuse_run_key(key, place)
        if isinstance(value, float) and not math.isfinite(value):
            raise UsageError(f"{place}: {key} is {value}; a finite number is needed")
    return settings


def _refuse_run_key(key: str, place: str) -> None:
    if re.split(r"[./@]", key.lstrip("+~"))[0] in RUN_KEYS:
        raise UsageError(f"{place}: '{key}' belongs to the run, not to a condition; give it on the command line")
