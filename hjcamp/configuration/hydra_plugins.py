"""What hjcamp adds to Hydra: campaigns and plants as configuration groups, the user's folders first, two resolvers, and trust."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from hydra._internal.core_plugins.file_config_source import FileConfigSource as HydrasFileConfigSource
from hydra._internal.hydra import Hydra
from hydra._internal.sources_registry import SourcesRegistry
from hydra.core.config_search_path import ConfigSearchPath, SearchPathQuery
from hydra.core.object_type import ObjectType
from hydra.core.plugins import Plugins
from hydra.plugins.config_source import ConfigLoadError, ConfigResult, ConfigSource
from hydra.plugins.search_path_plugin import SearchPathPlugin
from omegaconf import OmegaConf

from hjcamp.configuration import optuna_sweeper
from hjcamp.configuration.search_path import campaign_folders, configuration_folders, packaged_root
from hjcamp.configuration.trust import check_file, check_group, with_our_hydra
from hjcamp.errors import UsageError
from hjcamp.known_plants import OWN_PLANTS, plant_names
from hjcamp.model.files.user_folders import extension_folders
from hjcamp.rigs import OWN_RIGS, SHIPPED, rig_names
from hjcamp.yaml_file import check_yaml

GROUP = "campaign"
PLANT = "plant"
RIG = "rig"
PRIMARY = "config"


class FileConfigSource(HydrasFileConfigSource):
    """A folder of configuration files. Ours are trusted; any other may hold values, and nothing that names code to run.

    It stands for Hydra's own source of that name wherever a folder is given, on whichever way.
    """

    def load_config(self, config_path: str) -> ConfigResult:
        """Return what a file holds; raises ``UsageError`` with file and line where it may not hold that."""
        file = Path(self.path, self._normalize_file_name(config_path)).resolve()
        ours = (packaged_root() / "conf").resolve()
        if file.is_relative_to(ours):
            return self._shipped(file, config_path)
        check_group(file, config_path)
        check_yaml(file, mapping=True)
        result = super().load_config(config_path)
        if config_path == PRIMARY:
            config = with_our_hydra(file, result.config, OmegaConf.load(ours / f"{PRIMARY}.yaml"))
            return replace(result, config=config)
        check_file(file, result.config, result.header["package"])
        return result

    def _shipped(self, file: Path, config_path: str) -> ConfigResult:
        """Return what a file of ours holds, which is parsed once: Hydra asks for each of them three times in a run."""
        try:
            found = file.stat()
        except OSError:
            return super().load_config(config_path)  # which says that it is not there
        content, header = _parsed(file, found.st_mtime_ns, found.st_size)
        place = f"{self.scheme()}://{self.path}"
        return ConfigResult(config=OmegaConf.create(content), path=place, provider=self.provider, header=dict(header))


@functools.lru_cache(maxsize=512)
def _parsed(file: Path, changed_ns: int, size: int) -> tuple[Any, dict[str, str | None]]:
    """Return the plain values of a file and its header, as Hydra reads it; it is read again once it has changed."""
    with file.open(encoding="utf-8") as stream:
        header = ConfigSource._get_header_dict(stream.read(512))
    return OmegaConf.to_container(OmegaConf.load(file)), header


class CampaignSource(ConfigSource):
    """A folder of campaign files, seen by Hydra as the group ``campaign``: ``campaign=NAME`` is ``NAME.yaml``."""

    @staticmethod
    def scheme() -> str:
        """Return the scheme of the search path entries, ``campaigns://FOLDER``."""
        return "campaigns"

    def load_config(self, config_path: str) -> ConfigResult:
        """Return the campaign file as the configuration of the package ``campaign``."""
        file = self._file(config_path)
        if file is None:
            raise ConfigLoadError(f"Config not found : {config_path}")
        check_yaml(file)
        content = OmegaConf.load(file)
        check_file(file, content, None)
        if not OmegaConf.is_dict(content) or not content:
            raise UsageError(f"campaign file {file} holds no keys; it needs at least 'name' and 'vary'")
        return ConfigResult(config=content, path=str(file), provider=self.provider, header={"package": None})

    def available(self) -> bool:
        """Return whether the folder exists."""
        return Path(self.path).is_dir()

    def is_group(self, config_path: str) -> bool:
        """Return whether the path is the group itself."""
        return config_path.strip("/") in ("", GROUP)

    def is_config(self, config_path: str) -> bool:
        """Return whether a campaign file of that name exists."""
        file = self._file(config_path)
        # What is there and cannot be read must be refused by its name, not be passed over.
        return file is not None and (file.exists() or file.is_symlink())

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:
        """Return the names of the campaigns, or of the one group."""
        if config_path.strip("/") == "":
            return [] if results_filter == ObjectType.CONFIG else [GROUP]
        if config_path.strip("/") != GROUP or results_filter == ObjectType.GROUP:
            return []
        return sorted(file.stem for file in Path(self.path).glob("*.yaml"))

    def _file(self, config_path: str) -> Path | None:
        group, _, name = config_path.partition("/")
        if group != GROUP or not name or "/" in name:
            return None
        return Path(self.path) / f"{name.removesuffix('.yaml')}.yaml"


class _FilesOfPython(ConfigSource):
    """A folder of files of one class each, seen by Hydra as the group ``GROUP``: ``GROUP=NAME`` is ``NAME.py``."""

    group = ""
    package = ""

    def _names(self) -> list[str]:
        raise NotImplementedError

    def _settings(self, name: str) -> dict[str, Any]:
        raise NotImplementedError

    def load_config(self, config_path: str) -> ConfigResult:
        """Return what the choice sets."""
        if not self.is_config(config_path):
            raise ConfigLoadError(f"Config not found : {config_path}")
        content = OmegaConf.create(self._settings(self._name(config_path)))
        header: dict[str, str | None] = {"package": self.package}
        return ConfigResult(config=content, path=str(Path(self.path)), provider=self.provider, header=header)

    def available(self) -> bool:
        """Return whether the folder exists."""
        return Path(self.path).is_dir()

    def is_group(self, config_path: str) -> bool:
        """Return whether the path is the group itself."""
        return config_path.strip("/") in ("", self.group)

    def is_config(self, config_path: str) -> bool:
        """Return whether the folder holds a file of that name."""
        name = self._name(config_path)
        return name != "" and name in self._names()

    def list(self, config_path: str, results_filter: ObjectType | None) -> list[str]:
        """Return the names of the choices, or of the one group."""
        if config_path.strip("/") == "":
            return [] if results_filter == ObjectType.CONFIG else [self.group]
        if config_path.strip("/") != self.group or results_filter == ObjectType.GROUP:
            return []
        return self._names()

    def _name(self, config_path: str) -> str:
        group, _, name = config_path.partition("/")
        return name.removesuffix(".yaml") if group == self.group and "/" not in name else ""


class PlantSource(_FilesOfPython):
    """A folder of plants: ``plant=NAME`` is ``NAME.py``, which is loaded when chosen."""

    group, package = PLANT, "_global_"

    @staticmethod
    def scheme() -> str:
        """Return the scheme of the search path entries, ``plants://FOLDER``."""
        return "plants"

    def _names(self) -> list[str]:
        return plant_names(Path(self.path))

    def _settings(self, name: str) -> dict[str, Any]:
        from hjcamp.configuration.plant_settings import plant_settings

        return plant_settings(name)


class RigSource(_FilesOfPython):
    """A folder of rigs: ``rig=NAME`` is ``NAME.py``, which is loaded when a test needs it; in our own those that need no file."""

    group, package = RIG, RIG

    @staticmethod
    def scheme() -> str:
        """Return the scheme of the search path entries, ``rigs://FOLDER``."""
        return "rigs"

    def _names(self) -> list[str]:
        return list(SHIPPED) if Path(self.path) == OWN_RIGS else rig_names(Path(self.path))

    def _settings(self, name: str) -> dict[str, Any]:
        from hjcamp.configuration.plant_settings import rig_settings

        return rig_settings(name)


class UserFoldersFirst(SearchPathPlugin):
    """Put the user's configuration and campaigns before ours, and our campaigns next to our configuration."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        """Add the folders to Hydra's search path."""
        if not any(element.provider == "main" for element in search_path.get_path()):
            return
        for folder in campaign_folders():
            search_path.prepend("user", f"campaigns://{folder}", anchor="main")
        for folder in configuration_folders():
            search_path.prepend("user", f"file://{folder}", anchor="main")
        search_path.append("hjcamp", f"campaigns://{packaged_root() / 'campaigns'}", anchor=SearchPathQuery("main"))
        for folder in (*extension_folders("plants"), OWN_PLANTS):
            search_path.append("plants", f"plants://{folder}")
        for folder in (*extension_folders("rigs"), OWN_RIGS):
            search_path.append("rigs", f"rigs://{folder}")


def milli(value: float) -> float:
    """Return a thousandth: g to kg, mm to m."""
    return float(value) / 1000.0


def first(*values: object) -> object:
    """Return the first value that is not null."""
    return next((value for value in values if value is not None), None)


@contextmanager
def _installed_only() -> Iterator[None]:
    """Hide the working folder from imports: Hydra imports all of ``hydra_plugins``, and a folder there may be anybody's."""
    here, before = os.getcwd(), sys.path[:]
    sys.path[:] = [place for place in before if place and os.path.realpath(place) != os.path.realpath(here)]
    try:
        yield
    finally:
        sys.path[:] = before


def _mode(self: Hydra, config_name: str | None, overrides: list[str]) -> None:
    """Give no mode, which Hydra would find by composing everything once more: nothing can name one (`hjcamp.configuration.trust`)."""


def register() -> None:
    """Make the plugins known to Hydra; harmless when repeated."""
    with _installed_only():
        plugins = Plugins.instance()
    # Hydra has no way to exchange a source; under another name it would take its own for a second one.
    SourcesRegistry.instance().types["file"] = FileConfigSource
    Hydra.get_mode = _mode  # type: ignore[method-assign]
    plugins.register(CampaignSource)
    plugins.register(PlantSource)
    plugins.register(RigSource)
    plugins.register(UserFoldersFirst)
    optuna_sweeper.register()
    OmegaConf.register_new_resolver("milli", milli, replace=True)
    OmegaConf.register_new_resolver("first", first, replace=True)


register()
