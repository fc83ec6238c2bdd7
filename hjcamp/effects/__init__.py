"""The effect library: one physical effect is one file of this folder, or of the user's own ``effects`` folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hjcamp.errors import UsageError, shown, unknown
from hjcamp.known_plants import DEFAULT, find_plant, plants_and_faults
from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.plant import Plant
from hjcamp.model.files.catalogue import scan
from hjcamp.model.files.user_file import is_users
from hjcamp.model.files.user_folders import extension_folders
from hjcamp.model.language.effect_units import check_units
from hjcamp.model.language.library import Library, library_for


def effect_files(folders: Sequence[Path] | None = None) -> dict[str, type[Effect]]:
    """Return every effect as its file holds it, ours and the user's; a faulty file is refused, saying what is allowed."""
    chosen = extension_folders("effects") if folders is None else list(folders)
    return scan(Path(__file__).parent, __name__, Effect, chosen)


def imposed_files() -> dict[str, type[Effect]]:
    """Return what an experimenter may do to a rig: effects that a configuration names and no diagnosis proposes."""
    return scan(Path(__file__).parent / "imposed", f"{__name__}.imposed", Effect)


def library_of(plant: type[Plant] | str = DEFAULT, folders: Sequence[Path] | None = None, imposed: bool = False) -> Library:
    """Return the effects that fit a plant, generic ones bound to its places, and why the others do not.

    With ``imposed`` those as well that an experimenter puts on a rig on purpose.
    """
    if isinstance(plant, str):
        # ours does not depend on what plants the user has
        plant = find_plant(plant, folders=[] if plant == DEFAULT else None)
    files = effect_files(folders)
    if imposed:
        ours = imposed_files()
        for name in ours.keys() & files.keys():
            raise UsageError(f"effect {name}: the name is taken; choose another file name")
        files = {**files, **ours}
    return library_for(plant, files, lambda: plants_and_faults()[0].values())


def load_effects(folders: Sequence[Path] | None = None, plant: type[Plant] | str = DEFAULT) -> dict[str, type[Effect]]:
    """Return every effect that fits a plant, by its name there, ours and the user's."""
    return dict(library_of(plant, folders).effects)


def find_effect(name: str, plant: type[Plant] | str = DEFAULT, folders: Sequence[Path] | None = None) -> type[Effect]:
    """Return the effect that a plant calls ``name``; one that does not fit is refused with its reason."""
    return library_of(plant, folders, imposed=True).find(name)


def faults_of_own(plant: type[Plant]) -> list[str]:
    """Return a sentence for each effect of the user's that no place of a plant takes, or whose units do not agree there."""
    library = library_of(plant)
    own = {name for name, effect in effect_files().items() if is_users(effect.__module__) and effect.plant in ("", plant.name)}
    found = [f"{library.unfit[name]}: it is left out" for name in sorted(own & library.unfit.keys())]
    for effect in library.effects.values():
        if is_users(effect.__module__):
            try:
                check_units(effect, plant)
            except UsageError as problem:
                found.append(f"{problem}: what is said of its amounts may be wrong")
    return found


def chosen_effects(
    values: Mapping[str, Any], where: str = "effects", plant: type[Plant] | str = DEFAULT, period: float = 0.0
) -> tuple[list[type[Effect]], dict[str, dict[str, float]]]:
    """Return the effects of a configuration in alphabetical order, and their checked parameters.

    ``where`` is the path of ``values`` in the configuration; an effect without parameters has its defaults. A model
    that was fitted to logs of another ``period`` (s) than the plant's has its times within the bounds of those.
    """
    if not values and not extension_folders("effects"):
        return [], {}  # ours are right: without a file of the user's there is nothing to read
    chosen = find_plant(plant) if isinstance(plant, str) and period else plant
    library = library_of(chosen, imposed=True)
    bounded = library if isinstance(chosen, str) or not period else library_of(chosen.sampled(period), imposed=True)
    effects, checked = [], {}
    for name in sorted(values, key=str):
        if name not in library.effects and name not in {*library.unfit, *library.names}:
            raise unknown("effect", str(name), library.effects, where)
        effect = library.find(name)
        given = values[name]
        if given is None:
            raise UsageError(f"{where}.{name} is null; write {{}} for its defaults, or leave {name} out")
        if not isinstance(given, Mapping):
            raise UsageError(f"{where}.{name} is {shown(given)}; give its parameters as {where}.{name}.PARAMETER=VALUE")
        effects.append(effect)
        checked[name] = bounded.effects[name].checked(given, where)
    return effects, checked
