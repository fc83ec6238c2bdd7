"""Look into a nested configuration by dotted paths."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

VARIES = "varies"


def look_up(config: Mapping[str, Any], path: str) -> Any:
    """Return the value at a dotted path, None where there is none."""
    place: Any = config
    for part in path.split("."):
        if not isinstance(place, Mapping) or part not in place:
            return None
        place = place[part]
    return place


def common(values: Sequence[Any]) -> Any:
    """Return nested values as all have them, `VARIES` for each that differs; a group whose name differs varies as a whole."""
    first = values[0]
    if all(value == first for value in values):
        return first
    if not all(isinstance(value, Mapping) and value.get("name") == first.get("name") for value in values):
        return VARIES
    keys = dict.fromkeys(key for value in values for key in value)
    return {key: common([value.get(key) for value in values]) for key in keys}


def leaves(config: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each value of a nested configuration with its dotted path."""
    if isinstance(config, Mapping):
        for key, value in config.items():
            yield from leaves(value, f"{path}.{key}" if path else str(key))
    elif isinstance(config, list | tuple):
        for position, value in enumerate(config):
            yield from leaves(value, f"{path}[{position}]")
    else:
        yield path, config
