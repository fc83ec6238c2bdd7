"""Overrides as Hydra takes them, where a campaign or a choice says which groups and parameters there are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hjcamp.configuration.explain import Choices


def fitted(overrides: Sequence[str], composer: Choices) -> list[str]:
    """Return the overrides with Hydra's ``+`` and ``++`` where it needs them because of what a campaign, or a choice, says.

    A group within a group (controller/gains) is new where the choice of that has none. A parameter of a controller that a campaign
    chooses is not known before its conditions are made; those are checked.
    """
    keys = [line.partition("=")[0] for line in overrides]
    bare = [key.lstrip("+") for key in keys]
    within = ["/" in key and not key.startswith(("~", "hydra/")) and composer.is_group(key) for key in bare]
    by_campaign = any(key == "campaign" for key in keys)
    loose = [by_campaign and key[:1] not in "+~" and composer.is_group(key.partition(".")[0]) and "." in key for key in keys]
    if not any(within) and not any(loose):
        return list(overrides)
    chosen = [
        line
        for key, line in zip(keys, overrides, strict=True)
        if "/" not in key and line[len(key) + 1 :] in composer.options(key)
    ]
    known = composer.compose(chosen)

    def marked(line: str, key: str, inner: bool, own: bool) -> str:
        if inner:
            return ("" if key in known.choices else "+") + line.lstrip("+")
        return f"++{line}" if own and not _holds(known.config, key) else line

    return [marked(*one) for one in zip(overrides, bare, within, loose, strict=True)]


def _holds(config: Mapping[str, Any], key: str) -> bool:
    """Return whether a configuration has a parameter, by its dotted key."""
    place: Any = config
    for part in key.split("."):
        if not isinstance(place, Mapping) or part not in place:
            return False
        place = place[part]
    return True
