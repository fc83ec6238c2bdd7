"""Names that a plant may not give what it declares: those of composed laws, and those that every effect has for itself."""

from __future__ import annotations

from collections.abc import Iterable

from hjcamp.errors import UsageError
from hjcamp.model.declare.effect import RESERVED, Effect

# What laws that are made for a plant call, and their own names (`hjcamp.diagnosis.candidates.nonparametric_laws`).
OF_LAWS = frozenset({"abs", "float", "floor", "hypot", "int", "max", "min", "knots_at", "knots_from", "knots_to"})
# `gates` is the parameter by which a composed model switches its effects.
OF_EFFECTS = frozenset({"gates", *RESERVED, *(name for name in dir(Effect) if not name.startswith("_"))})
# A method of an effect that is called so belongs to a state of its own.
OF_STATES = ("d_", "next_", "start_")


def refuse_own_names(names: Iterable[str], acted_on: Iterable[str], where: str) -> None:
    """Raise UsageError for a declared name that is a function of laws, or, where effects act on it, a name of theirs."""
    for name in names:
        if name in OF_LAWS:
            raise UsageError(f"{where}: '{name}' is a name that laws use; call this one otherwise, such as '{free_name(name)}'")
    for name in acted_on:
        if why := of_effects(name):
            raise UsageError(f"{where}: '{name}' {why}; call this one otherwise, such as '{free_name(name)}'")


def of_effects(name: str) -> str:
    """Return in words why no effect can act on what is called so; empty where it can."""
    if name in OF_EFFECTS:
        return "is a name that every effect has for itself"
    prefix = next((one for one in OF_STATES if name.startswith(one)), "")
    return f"begins with '{prefix}', as methods of an effect's own states do" if prefix else ""


def free_name(name: str) -> str:
    """Return the nearest name that is free."""
    return f"{name}_" if name in OF_EFFECTS | OF_LAWS else f"own_{name}"
