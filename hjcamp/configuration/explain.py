"""Turn Hydra's errors into one message that names the nearest match."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from hjcamp.errors import UsageError, unknown

if TYPE_CHECKING:
    from hydra.core.override_parser.types import Override


class Choices(Protocol):
    """What a composer knows of its groups: which there are, their options, and what some choices compose to."""

    def is_group(self, name: str) -> bool: ...
    def options(self, group: str) -> Sequence[str]: ...
    def groups(self) -> Sequence[str]: ...
    def compose(self, overrides: Sequence[str]) -> Any: ...


def explain(error: Exception, overrides: Sequence[str], composer: Choices) -> UsageError:
    """Return what is wrong with the overrides, found by looking at each, else Hydra's own first words."""
    from hjcamp.configuration.overrides import parse_overrides

    try:
        parsed = [item for item in parse_overrides(overrides) if not item.is_hydra_override()]
        for item in parsed:
            found = _wrong_choice(item, composer)
            if found is not None:
                return found
        groups = [item for item in parsed if composer.is_group(item.key_or_group)]
        found = _wrong_key(parsed, groups, composer) if len(groups) < len(parsed) else None
        return found or _missing_source(error, parsed) or UsageError(first_words(error))
    except UsageError as usage:
        return usage


def _wrong_choice(item: Override, composer: Choices) -> UsageError | None:
    if not composer.is_group(item.key_or_group) or item.is_delete() or item.is_sweep_override():
        return None
    allowed = composer.options(item.key_or_group)
    value = item.value()
    if isinstance(value, Mapping):
        return None
    choices = value if isinstance(value, list) else [value]
    for choice in choices:
        if choice is None:
            if item.key_or_group == "campaign":
                return UsageError("campaign=null names no campaign; leave it out, or write campaign=NAME")
            return UsageError(f"{item.key_or_group}=null leaves the group empty. Allowed: {', '.join(allowed)}")
        if str(choice) not in allowed:
            return unknown(item.key_or_group, str(choice), allowed)
    return None


def _wrong_key(parsed: Sequence[Override], groups: Sequence[Override], composer: Choices) -> UsageError | None:
    from hydra.errors import HydraException

    try:
        base = composer.compose([item.input_line for item in groups if item.input_line])
    except (UsageError, HydraException):
        return None
    for item in parsed:
        if item in groups or item.is_add() or item.is_force_add():
            continue
        parts = item.key_or_group.replace("/", ".").split(".")
        place: Any = base.config
        for depth, part in enumerate(parts):
            if not isinstance(place, Mapping):
                return UsageError(f"{'.'.join(parts[:depth])} is a value, it has no '{part}'")
            if part not in place:
                names = set(map(str, place))
                if depth == 0:
                    names |= set(composer.groups())
                where = ".".join(parts[:depth])
                return unknown("parameter" if where else "group or parameter", part, names, where)
            place = place[part]
    return None


def _missing_source(error: BaseException, parsed: Sequence[Override]) -> UsageError | None:
    """Return what to say of a value that follows another one, such as a scale, which is not there."""
    from omegaconf.errors import InterpolationKeyError

    found = re.search(r"Interpolation key '(\w+)\.([^']+)' not found", str(error))
    key = getattr(error, "full_key", None)
    if not isinstance(error, InterpolationKeyError) or found is None or not key:
        return None
    group, name = found.groups()
    if any(item.is_delete() and item.key_or_group == group for item in parsed):
        return UsageError(f"the group '{group}' is missing; every condition needs a choice of it ({key} follows it)")
    return UsageError(
        f"{key} follows {group}.{name}, which the chosen '{group}' does not say: add it to that file, or say {key}=VALUE"
    )


def first_words(error: BaseException) -> str:
    """Return Hydra's or OmegaConf's message on one line, with its cause where the message itself is empty."""
    cause: BaseException | None = error
    texts: list[str] = []
    while cause is not None:
        text = " ".join(line.strip() for line in str(cause).splitlines() if line.strip())
        if text and text not in texts:
            texts.append(text)
        cause = cause.__cause__
    return "configuration: " + (": ".join(texts[:2]) or type(error).__name__)
