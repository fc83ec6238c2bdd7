"""Join configurations that differ from one base in choices and single values: each part is composed once."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hydra.core.override_parser.types import Override, OverrideType
from omegaconf import OmegaConf

PLAIN_KEY = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*")
INTERPOLATED = "${"
PLANT = "plant"
CAMPAIGN = "campaign"


class NotJoinedError(Exception):
    """The overrides do more than choose options and set values: they are composed from the beginning."""


@dataclass(frozen=True)
class Loaded:
    """A composed configuration with its interpolations unresolved, and the choice of each group, in Hydra's order."""

    config: dict[str, Any]
    choices: dict[str, str]


#: Parts of a configuration by the overrides that they are composed of, with the keys that differ from the base.
Parts = dict[tuple[str, ...], tuple[Loaded, frozenset[str]]]


class Variations:
    """Configurations of one search path, joined from the base and from what choices of groups change in it.

    ``load`` composes overrides by Hydra; ``is_group`` tells a group from a parameter. Choices that change the same part
    of the configuration are composed together, once. ``shared`` are the parts without a plant that others composed of
    the same files.
    """

    def __init__(
        self, load: Callable[[Sequence[Override]], Loaded], is_group: Callable[[str], bool], shared: Parts | None = None
    ) -> None:
        self._load, self._is_group = load, is_group
        self._shared: Parts = {} if shared is None else shared
        # what a plant brings is made by its Python file
        self._of_plants: Parts = {}
        self._resolved: dict[tuple[str, ...], Any] = {}

    def compose(self, overrides: Sequence[Override]) -> Loaded:
        """Return the resolved configuration and the choices; raises ``NotJoinedError`` and Hydra's errors."""
        chosen: dict[str, list[Override]] = {}
        values: list[Override] = []
        for override in overrides:
            of_hydra = override.is_hydra_override() or _group(override.key_or_group) == "hydra"
            if override.package is not None or of_hydra or override.is_sweep_override():
                raise NotJoinedError
        if any(override.key_or_group == CAMPAIGN for override in overrides):
            return self._whole(overrides)  # what a campaign says is the business of every part
        for override in overrides:
            if not self._is_group(override.key_or_group):
                values.append(override)
            elif override.type == OverrideType.CHANGE and isinstance(override.value(), str):
                chosen.setdefault(_group(override.key_or_group), []).append(override)
            else:
                raise NotJoinedError
        # another plant has other groups: it is the base of all that varies with it
        plant = chosen.pop(PLANT, [])
        base, _ = self._part(plant, [])
        config, usual = dict(base.config), _by_group(base.choices)
        choices = dict(usual)
        for groups in self._together(plant, chosen):
            loaded, changed = self._part(plant, [override for group in groups for override in chosen[group]])
            config |= {key: loaded.config[key] for key in changed}
            own = _by_group(loaded.choices)
            # a choice may bring that of another group, where that is not asked for
            choices |= {group: one for group, one in own.items() if group in groups or one != usual.get(group)}
        config = copy.deepcopy(config)
        for override in values:
            _set(config, override)
        return Loaded(
            resolved(config, self._resolved), {name: choice for found in choices.values() for name, choice in found.items()}
        )

    def _whole(self, overrides: Sequence[Override]) -> Loaded:
        """Return what is composed of all overrides at once, with nothing joined; kept where they choose options and set no value."""
        key = tuple(override.input_line or "" for override in overrides)
        loaded, _ = self._of_plants.get(key) or self._shared.get(key) or (self._load(overrides), frozenset())
        if all(self._is_group(override.key_or_group) for override in overrides):
            known = self._of_plants if loaded.choices.get(PLANT) else self._shared
            if key not in known:
                known[key] = loaded, frozenset()
        return Loaded(resolved(copy.deepcopy(loaded.config), self._resolved), dict(loaded.choices))

    def _together(self, plant: list[Override], chosen: Mapping[str, list[Override]]) -> list[list[str]]:
        """Return the groups whose choices change the same part of the configuration, together; others alone."""
        parts: list[tuple[list[str], frozenset[str]]] = []
        for group, overrides in chosen.items():
            # its own part is asked for, though it may be that of the base
            groups, changed = [group], self._part(plant, overrides)[1] | {group}
            for other in [part for part in parts if part[1] & changed]:
                parts.remove(other)
                groups = [*other[0], *groups]
                changed |= other[1]
            parts.append((groups, changed))
        return [groups for groups, _ in parts]

    def _part(self, plant: Sequence[Override], overrides: Sequence[Override]) -> tuple[Loaded, frozenset[str]]:
        """Return what is composed of a plant and overrides, and the keys that differ from the base: the plant alone."""
        key = tuple(override.input_line or "" for override in (*plant, *overrides))
        known = self._of_plants if plant else self._shared
        if key not in known:
            loaded = self._load([*plant, *overrides])
            changed: frozenset[str] = frozenset()
            if overrides:
                base, _ = self._part(plant, [])
                if list(base.config) != list(loaded.config):
                    raise NotJoinedError
                changed = frozenset(key for key, part in loaded.config.items() if _text(part) != _text(base.config[key]))
            known[key] = loaded, changed
        return known[key]


def _group(name: str) -> str:
    return name.split("/")[0]


def _by_group(choices: Mapping[str, str]) -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = {}
    for name, choice in choices.items():
        found.setdefault(_group(name), {})[name] = choice
    return found


def _text(part: Any) -> str:
    # keeps the order of keys and tells 1 from 1.0 and true
    return json.dumps(part, default=repr)


def _set(config: dict[str, Any], override: Override) -> None:
    """Set one value as Hydra would; raises ``NotJoinedError`` for all but plain values in their place."""
    value = override.value()
    if not PLAIN_KEY.fullmatch(override.key_or_group) or isinstance(value, dict | list) or override.is_delete():
        raise NotJoinedError
    *parents, name = override.key_or_group.split(".")
    place: Any = config
    for parent in parents:
        if override.is_force_add() and parent not in place:
            place[parent] = {}
        place = place.get(parent)
        if not isinstance(place, dict):
            raise NotJoinedError
    fits = override.is_force_add() or (name in place) != override.is_add()
    if not fits or isinstance(place.get(name), dict | list):
        raise NotJoinedError
    place[name] = value


def resolved(config: dict[str, Any], known: dict[tuple[str, ...], Any]) -> dict[str, Any]:
    """Return the configuration with its interpolations resolved.

    OmegaConf gets each part that holds one, with the parts that it names, once: ``known`` keeps the results by the texts of
    these parts.
    """
    texts = {key: _text(part) for key, part in config.items()}
    found = dict(config)
    for key, text in texts.items():
        if INTERPOLATED not in text:
            continue
        concerned = _concerned(key, texts)
        place = (key, *(f"{name}: {texts[name]}" for name in concerned))
        if place not in known:
            part = OmegaConf.to_container(OmegaConf.create({name: config[name] for name in concerned}), resolve=True)
            assert isinstance(part, dict)
            known[place] = part[key]
        found[key] = copy.deepcopy(known[place])
    return found


def _concerned(key: str, texts: Mapping[str, str]) -> list[str]:
    """Return the parts that an interpolation in the part ``key`` can lead to, itself among them."""
    reached, waiting = {key}, [key]
    while waiting:
        for found in re.findall(r"\$\{[^}]*\}", texts[waiting.pop()]):
            new = {word for word in re.findall(r"\w+", found) if word in texts} - reached
            reached |= new
            waiting += new
    return [name for name in texts if name in reached]
