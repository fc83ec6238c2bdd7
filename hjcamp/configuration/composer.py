"""Compose the configuration of one condition from the groups; the one place that knows Hydra's loader."""

from __future__ import annotations

import copy
import functools
import pickle
import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.config_repository import CachingConfigRepository, ConfigRepository
from hydra._internal.config_search_path_impl import ConfigSearchPathImpl
from hydra._internal.defaults_list import create_defaults_list
from hydra._internal.utils import create_config_search_path
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.default_element import GroupDefault, InputDefault
from hydra.core.object_type import ObjectType
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Glob, Override
from hydra.core.utils import setup_globals
from hydra.errors import HydraException
from hydra.plugins.config_source import ConfigResult
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf, open_dict
from omegaconf.errors import OmegaConfBaseException

from hjcamp.configuration import hydra_plugins
from hjcamp.configuration.explain import explain
from hjcamp.configuration.fitted import fitted
from hjcamp.configuration.overrides import parse_overrides
from hjcamp.configuration.search_path import packaged_root
from hjcamp.configuration.shared_parts import parts_of
from hjcamp.configuration.trust import check_overrides
from hjcamp.configuration.variation import Loaded, NotJoinedError, Variations
from hjcamp.errors import UsageError, shown, unknown
from hjcamp.known_plants import OWN_PLANTS
from hjcamp.model.language.field_unit import FIELD_UNITS
from hjcamp.rigs import OWN_RIGS

# Hydra reports some misuse (campaign=null) as a bare ValueError.
#: Groups whose choices make other parts of the configuration.
WITHOUT_KEY = ("campaign", "plant")
COMPOSE_ERRORS = (HydraException, OmegaConfBaseException, yaml.YAMLError, ValueError, TypeError, AssertionError, RecursionError)
MAIN = "config"
FREE_KEYS = ("procedure.phases.", "effects.", "model.effects.", "model.parameters.", "parameters.", "start.")


@dataclass(frozen=True)
class Composition:
    """One composed configuration: ``config`` resolved to plain values, ``choices`` the option of each group."""

    config: dict[str, Any]
    choices: dict[str, str]


class _FilesReadOnce(ConfigRepository):
    """Hydra's repository, but a file is parsed once for all conditions: half the time of composing."""

    _read: dict[str, tuple[ConfigResult, bytes] | None]

    def initialize_sources(self, config_search_path: ConfigSearchPath) -> None:
        super().initialize_sources(config_search_path)
        # Other places hold other files.
        self._read = {}

    def load_config(self, config_path: str) -> ConfigResult | None:
        if config_path not in self._read:
            result = super().load_config(config_path)
            self._read[config_path] = None if result is None else (result, pickle.dumps(result.config))
        read = self._read[config_path]
        # Composing writes into what it is given, and a copy takes five times as long.
        return None if read is None else replace(read[0], config=pickle.loads(read[1]))

    def __deepcopy__(self, memo: dict[int, Any]) -> _FilesReadOnce:
        # Hydra copies the repository for every composition; a search path in the overrides must not leak out.
        copied = _FilesReadOnce.__new__(_FilesReadOnce)
        copied.config_search_path = getattr(self, "config_search_path", None)  # type: ignore[assignment]
        copied.sources = list(self.sources)
        copied._read = self._read
        return copied


class _WithoutHydra(CachingConfigRepository):
    """A repository in which the main file says nothing of Hydra's own configuration."""

    def load_config(self, config_path: str) -> ConfigResult | None:
        result = super().load_config(config_path)
        if result is None or result.defaults_list is None:
            return result
        if any("${" in str(getattr(entry, "value", "")) for entry in result.defaults_list):
            raise NotJoinedError  # what one group brings depends on the choice of another
        if config_path == MAIN and isinstance(result.config, DictConfig) and "hydra" in result.config:
            result.config.pop("hydra")
            result.defaults_list = [one for one in result.defaults_list if not _of_hydra(one)]
        return result


def _of_hydra(entry: InputDefault) -> bool:
    return isinstance(entry, GroupDefault) and (entry.group or "").split("/")[0] == "hydra"


class Composer:
    """Composes configurations over one search path.

    ``sources`` is the search path of a running Hydra job as (provider, address) pairs; without it the standard one is
    used, with ``folder`` (``--config-dir``) behind it.
    """

    def __init__(self, sources: Iterable[tuple[str, str]] | None = None, folder: Path | None = None) -> None:
        setup_globals()
        hydra_plugins.register()
        if sources is None:
            path: ConfigSearchPath = create_config_search_path(str(packaged_root() / "conf"))
            if folder is not None:
                if not folder.is_dir():
                    raise UsageError(f"configuration folder {folder} not found")
                path.prepend("command-line", f"file://{folder.resolve()}", anchor="schema")
        else:
            path = ConfigSearchPathImpl()
            for provider, address in sources:
                path.append(provider, address)
        self._models: dict[str, dict[str, Any]] = {}
        self._loader = ConfigLoaderImpl(path)
        self._loader.repository = _FilesReadOnce(path)
        shared = parts_of(self._loader.repository.get_sources())
        self._variations = Variations(self._load, self.is_group, shared)

    def compose(self, overrides: Sequence[str]) -> Composition:
        """Return the configuration under ``overrides`` (Hydra's grammar).

        Raises ``UsageError`` for an unknown group, choice or parameter, with the nearest match.
        """
        check_overrides(overrides, parse_overrides)
        self.refuse_bundles(overrides)
        self._refuse_unfit(overrides)
        overrides = fitted(overrides, self)
        try:
            found = self._variations.compose([_parsed(line) for line in overrides])
            return self._named(found.config, found.choices)
        except (NotJoinedError, *COMPOSE_ERRORS):
            pass
        try:
            composed = self._loader.load_configuration(MAIN, list(overrides), RunMode.RUN)
            choices = {str(group): choice for group, choice in composed.hydra.runtime.choices.items()}
            with open_dict(composed):
                composed.pop("hydra")
            config = OmegaConf.to_container(composed, resolve=True)
        except RecursionError as error:
            circle = _circle(error)
            raise UsageError(
                f"the configuration refers to itself{': the defaults of ' if circle else ''}{', '.join(circle)}"
            ) from None
        except COMPOSE_ERRORS as error:
            raise explain(error, overrides, self) from error
        assert isinstance(config, dict)
        choices = {group: choice for group, choice in choices.items() if not group.startswith("hydra/")}
        return self._named({str(key): value for key, value in config.items()}, choices)

    def _named(self, config: dict[str, Any], choices: dict[str, str]) -> Composition:
        """Return the composition, each group with its name; refuse a choice that is no name of one."""
        for group, choice in choices.items():
            if choice is not None and any(part[:1] in ("", ".", "_") for part in str(choice).split("/")):
                raise unknown(group, str(choice), self.options(group))
            if choice is not None and group not in config and "/" not in group and group not in WITHOUT_KEY:
                raise UsageError(
                    f"{group}={choice}: this choice gives no '{group}' (an '@package' at its top puts it elsewhere?)"
                )
            if choice is not None and isinstance(config.get(group), dict) and group != "campaign":
                config[group].setdefault("name", choice)
        if config.get("plant") and isinstance(config.get("rig"), dict):
            from hjcamp.configuration.plant_settings import rig_of_plant

            config["rig"] = rig_of_plant(config["rig"], str(config["plant"].get("name")))
        return Composition(config, choices)

    def set_by(self, group: str, choice: str) -> set[str]:
        """Return the parameters that a choice of a group within a group sets, with the group's name before each."""
        found = self._loader.repository.load_config(f"{group}/{choice}")
        names = found.config if found is not None and isinstance(found.config, DictConfig) else ()
        return {f"{group.rpartition('/')[0].replace('/', '.')}.{name!s}" for name in names}

    def _refuse_unfit(self, overrides: Sequence[str]) -> None:
        """Raise ``UsageError`` for a controller that does not fit the plant: its values may follow hardware that is not there."""
        chosen = dict(line.partition("=")[::2] for line in overrides if line.startswith(("plant=", "controller=")))
        if chosen.get("plant") not in self.options("plant") or chosen.get("controller") not in self.options("controller"):
            return
        from hjcamp.configuration.plant_settings import refuse_unfit

        refuse_unfit(chosen["controller"], chosen["plant"])

    def refuse_bundles(self, overrides: Sequence[str]) -> None:
        """Raise ``UsageError`` for a group that is given a list or a mapping in the place of one choice, and for two campaigns."""
        campaigns = dict.fromkeys(line for line in overrides if line.startswith("campaign="))
        if len(campaigns) > 1:
            raise UsageError(f"{' '.join(campaigns)}: a run is of one campaign; run them one after the other")
        for line in overrides:
            key, _, value = line.partition("=")
            group = key.lstrip("+")
            if not value.startswith(("[", "{")) or not self.is_group(group):
                continue
            inside = value.strip("[]{} ").replace(" ", "")
            if value.startswith("["):
                hint = f"one after the other: hjcamp run -m {group}={inside}"
            else:
                hint = f"choose with {group}=NAME and set a parameter with {group.replace('/', '.')}.PARAMETER=VALUE"
            allowed = ", ".join(self.options(group))
            raise UsageError(f"{shown(line)}: a group takes one choice; {hint}. Allowed: {allowed}")

    def _load(self, overrides: Sequence[Override]) -> Loaded:
        """Compose without Hydra's own configuration, which takes half the time; where a user has files, the base with it: a check."""
        if not overrides and self._users_files():
            self._loader.load_configuration(MAIN, [], RunMode.RUN)
        repository = _WithoutHydra(self._loader.repository)
        found = create_defaults_list(repository, MAIN, list(overrides), prepend_hydra=False, skip_missing=False)
        composed = self._loader._compose_config_from_defaults_list(found.defaults, repository)
        OmegaConf.set_struct(composed, True)
        self._loader._apply_overrides_to_config(found.config_overrides, composed)
        config = OmegaConf.to_container(composed)
        assert isinstance(config, dict)
        choices: dict[str, Any] = {str(group): choice for group, choice in found.overrides.known_choices.items()}
        return Loaded({str(key): value for key, value in config.items()}, choices)

    def model(self, name: str) -> dict[str, Any]:
        """Return the group ``model`` as saved under ``name``; ``UsageError`` for one that cannot be calculated with."""
        from hjcamp.configuration.check import check_model
        from hjcamp.schema import naming

        if name not in self._models:
            if name not in self.options("model"):
                raise unknown("model", name, self.options("model"))
            content = self.compose([f"model={name}"]).config["model"]
            with naming(f"model '{name}'"):
                check_model(content, "model")
            self._models[name] = content
        return copy.deepcopy(self._models[name])

    def tell_choices(self, lines: Sequence[Override]) -> None:
        """Let parsed overrides know the choices of the groups; ``glob(*)`` among their values asks for them."""
        for line in lines:
            line.config_loader = self._loader
            if isinstance(line.value(), Glob) and next(line.sweep_string_iterator(), None) is None:
                group = line.key_or_group
                allowed = f"'{group}' is no group of choices: list its values with commas"
                if self.is_group(group):
                    allowed = f"allowed: {', '.join(self.options(group))}"
                raise UsageError(f"'{line.input_line}': nothing matches; {allowed}")

    def sweeper(self, overrides: Sequence[str]) -> dict[str, Any]:
        """Return the settings of Hydra's sweeper in a sweep with these overrides."""
        try:
            composed = self._loader.load_configuration(MAIN, list(overrides), RunMode.MULTIRUN)
            found = OmegaConf.to_container(composed.hydra.sweeper, resolve=True, enum_to_str=True)
        except COMPOSE_ERRORS as error:
            raise explain(error, overrides, self) from error
        assert isinstance(found, dict)
        return {str(key): value for key, value in found.items()}

    def is_group(self, key: str) -> bool:
        """Return whether ``key`` names a group (``trajectory``, ``controller/gains``) rather than a parameter."""
        return bool(key) and self._loader.repository.group_exists(key.split("@")[0])

    def options(self, group: str) -> list[str]:
        """Return the choices of a group, the user's and ours."""
        names = self._loader.repository.get_group_options(group, ObjectType.CONFIG)
        return [name for name in names if not name.startswith("_")]

    def groups(self) -> list[str]:
        """Return the names of the top-level groups."""
        names = self._loader.repository.get_group_options("", ObjectType.GROUP)
        return [name for name in names if name != "hydra" and self.options(name)]

    def complete(self, word: str) -> list[str]:
        """Return the groups, choices and parameters that may follow ``word`` on a command line."""
        group, equals, _ = word.partition("=")
        if equals and self.is_group(group):
            found = [f"{group}={choice}" for choice in self.options(group)]
        else:
            parent = group.rpartition(".")[0]
            place: Any = self.compose([]).config
            for part in parent.split(".") if parent else []:
                place = place.get(part) if isinstance(place, Mapping) else None
            names = place if isinstance(place, Mapping) else {}
            dot = f"{parent}." if parent else ""
            found = [f"{dot}{name}" + ("." if isinstance(value, Mapping) else "=") for name, value in names.items()]
            if not parent:
                found += [f"{name}=" for name in self.groups()]
        return sorted(name for name in set(found) if name.startswith(word))

    def _users_files(self) -> bool:
        """Return whether there is a folder of configuration next to our own."""
        folders = {Path(place.partition("://")[2]) for place in self.places()} - {OWN_PLANTS, OWN_RIGS}
        return any(folder.is_dir() and not folder.resolve().is_relative_to(packaged_root()) for folder in folders)

    def places(self) -> list[str]:
        """Return where configuration is looked for, first wins."""
        sources = self._loader.repository.get_sources()
        return [f"{source.scheme()}://{source.path}" for source in sources if source.provider not in ("hydra", "schema")]


@functools.lru_cache(maxsize=1024)
def _parsed(line: str) -> Override:
    return OverridesParser.create().parse_override(line)


def _circle(error: RecursionError) -> list[str]:
    """Return the files whose lists of defaults lead back to themselves, as Hydra was reading them."""
    frames = [frame for frame, _ in traceback.walk_tb(error.__traceback__)]
    paths = [frame.f_locals.get("path") for frame in frames if frame.f_code.co_name == "_create_defaults_tree_impl"]
    return sorted({path for path in paths if isinstance(path, str) and paths.count(path) > 2})


def as_override(key: str, value: Any) -> str:
    """Return ``key=value`` in Hydra's grammar; a key of a free mapping (effects) may be new, others must exist."""
    bare = key.lstrip("+")
    sign = "++" if _may_be_new(bare) else key[: len(key) - len(bare)]
    return f"{sign}{bare}={as_value(value)}"


def as_value(value: Any) -> str:
    """Return a plain value as Hydra's grammar writes it."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{key}:{as_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ",".join(as_value(item) for item in value) + "]"
    text = str(value)
    if text and all(letter.isalnum() or letter in "_-." for letter in text):
        return text
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def free(line: str) -> str:
    """Return an override of the command line, with ``++`` put before a key of a free mapping (``effects.``)."""
    return f"++{line}" if _may_be_new(line.partition("=")[0]) else line


def _may_be_new(key: str) -> bool:
    """Return whether a key is of a free mapping, or a size of a trajectory in another unit than deg (``amplitude_mm``)."""
    of_trajectory = key.startswith("trajectory.") and "_" in key
    return key.startswith(FREE_KEYS) or (of_trajectory and key.rpartition("_")[2] in {*FIELD_UNITS} - {"deg", "s"})
