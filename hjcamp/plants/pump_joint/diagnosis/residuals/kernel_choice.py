"""Which kernel simulates a candidate: that of the library, which is compiled once, or a small one of the user's effects."""

from __future__ import annotations

import functools
from collections.abc import Collection
from typing import Any

from hjcamp.effects import load_effects
from hjcamp.model.compile.kernel_cache import is_compiled
from hjcamp.plants.pump_joint.diagnosis.measured.hardware import simulator

Effects = tuple[Any, ...]
# The setup itself may bring it: whatever is simulated, a weight on the arm may have to be.
WEIGHT = "gravity_load"


def chosen_for(chosen: Effects, names: Collection[str]) -> Effects:
    """Return the effects that the kernel must have for a candidate with the effects ``names`` of those ``chosen``.

    Without any it is several times faster than with all gates closed. A user's effects have a kernel of their own, so
    that a new or changed one compiles in seconds; only one together with one of the library needs all in one.
    """
    if not names:
        return ()
    for effects in _apart(chosen):
        if set(names) <= {effect.name for effect in effects}:
            return effects
    return chosen


def first_needed(chosen: Effects) -> list[Effects]:
    """Return the sets of effects whose kernels a diagnosis with the ``chosen`` effects begins with."""
    return list(dict.fromkeys([(), *(_apart(chosen) or [chosen])]))


def _apart(chosen: Effects) -> list[Effects]:
    """Return the library and the user's effects; nothing where few are chosen and the library is not compiled."""
    some, whole = [effect for effect in chosen if _shipped(effect)], _library()
    if len(some) < len(whole) and not _library_is_compiled():
        return []
    own = _own(chosen)
    found = [whole] if some else []
    return [*found, own] if any(not _shipped(effect) for effect in own) else found


def _own(chosen: Effects) -> Effects:
    return tuple(effect for effect in chosen if not _shipped(effect) or effect.name == WEIGHT)


def _shipped(effect: Any) -> bool:
    return bool(effect.__module__.startswith("hjcamp.effects."))


@functools.cache
def _library() -> Effects:
    return tuple(load_effects([]).values())


@functools.cache
def _library_is_compiled() -> bool:
    return is_compiled(simulator(_library(), "pump").source)
