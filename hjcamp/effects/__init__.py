"""The effect library: one physical effect is one file of this folder, or of the user's own ``effects`` folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.model.binding import Library, library_for
from hjcamp.model.catalogue import scan
from hjcamp.model.effect import Effect
from hjcamp.model.plant import Plant
from hjcamp.model.user_folders import extension_folders


def load_effects(folders: Sequence[Path] | None = None) -> dict[str, type[Effect]]:
    """Return every effect by name, ours and the user's; a faulty file is refused, saying what is allowed."""
    chosen = extension_folders("effects") if folders is None else list(folders)
    return scan(Path(__file__).parent, __name__, Effect, chosen)


def library_of(plant: type[Plant], folders: Sequence[Path] | None = None) -> Library:
    """Return the effects that fit a plant, generic ones bound to its places, and why the others do not."""
    return library_for(plant, load_effects(folders))


def find_effect(name: str, folders: Sequence[Path] | None = None) -> type[Effect]:
    """Return the effect called ``name``."""
    effects = load_effects(folders)
    if name not in effects:
        raise unknown("effect", name, effects)
    return effects[name]


def chosen_effects(
    values: Mapping[str, Any], where: str = "effects"
) -> tuple[list[type[Effect]], dict[str, dict[str, float]]]:
    """Return the effects of a configuration in alphabetical order, and their checked parameters.

    ``where`` is the path of ``values`` in the configuration; an effect without parameters has its defaults.
    """
    library = load_effects()
    effects, checked = [], {}
    for name in sorted(values, key=str):
        if name not in library:
            raise unknown("effect", str(name), library, where)
        given = {} if values[name] is None else values[name]
        if not isinstance(given, Mapping):
            raise UsageError(f"{where}.{name} is {shown(given)}; give its parameters as {where}.{name}.PARAMETER=VALUE")
        effects.append(library[name])
        checked[name] = library[name].checked(given, where)
    return effects, checked
