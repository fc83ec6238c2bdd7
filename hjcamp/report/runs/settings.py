"""How two resolved configurations differ, in values and in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

#: What does not decide the physics of a test: who carries it out, how often, and with which draws.
NO_PHYSICS = ("backend", "rig", "repetitions", "seed")
ABSENT: Any = object()


def difference(config: Mapping[str, Any], published: Mapping[str, Any]) -> list[str]:
    """Return where a resolved configuration differs from a published one, in words; nothing where the physics is equal.

    A group with another name counts once: ``tubing is hdpe_300mm instead of ldpe_300mm``.
    """
    found = []
    for group in dict.fromkeys((*published, *config)):
        if group in NO_PHYSICS:
            continue
        pairs = unequal(config.get(group), published.get(group), group)
        names = next(((ours, theirs) for key, ours, theirs in pairs if key == f"{group}.name"), None)
        parts = [_in_words(key, ours, theirs) for key, ours, theirs in pairs if key != f"{group}.name"]
        if parts and names:
            parts = [_in_words(group, *names)]
        found += parts
    return found


def unequal(ours: Any, theirs: Any, key: str = "") -> list[tuple[str, Any, Any]]:
    """Return every value that differs between two nested configurations, with `ABSENT` where one has none; theirs first.

    Inside a group an empty mapping differs from none: it is an effect with its parameters as they are by default.
    """
    return sorted(_unequal(ours, theirs, key), key=lambda one: one[2] is ABSENT)


def _unequal(ours: Any, theirs: Any, key: str) -> Iterator[tuple[str, Any, Any]]:
    held = [side for side in (ours, theirs) if isinstance(side, Mapping)]
    if not held:
        if not equal(ours, theirs):
            yield key, ours, theirs
    elif len(held) == 2 or ABSENT in (ours, theirs):
        if not any(held) and len(held) == 1 and "." in key:
            yield key, ours, theirs
        for name in dict.fromkeys(name for side in reversed(held) for name in side):
            one, other = (side.get(name, ABSENT) if isinstance(side, Mapping) else ABSENT for side in (ours, theirs))
            yield from _unequal(one, other, f"{key}.{name}" if key else str(name))
    else:
        yield from _unequal(ours, ABSENT, key)
        yield from _unequal(ABSENT, theirs, key)


def leaves(value: Any, key: str) -> Iterator[tuple[str, Any]]:
    """Yield every value of a nested configuration under its full name; an empty mapping yields nothing."""
    if isinstance(value, Mapping):
        for name, part in value.items():
            yield from leaves(part, f"{key}.{name}" if key else str(name))
    else:
        yield key, value


def equal_leaves(configurations: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Any]]:
    """Yield the values that all of some nested configurations have, under their full names."""
    flat = [dict(leaves(one, "")) for one in configurations]
    for key, value in flat[0].items() if flat else ():
        if all(key in one and equal(one[key], value) for one in flat):
            yield key, value


def equal(one: Any, other: Any) -> bool:
    """Return whether two values are the same; numbers up to the rounding of text."""
    numbers = [value for value in (one, other) if isinstance(value, int | float) and not isinstance(value, bool)]
    if len(numbers) == 2:
        return math.isclose(*numbers, rel_tol=1e-9)
    return type(one) is type(other) and one == other


def _in_words(key: str, ours: Any, theirs: Any) -> str:
    return f"{key} is {_shown(ours)} instead of {_shown(theirs)}"


def _shown(value: Any) -> str:
    if value is ABSENT:
        return "absent"
    return "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
