"""What hjcamp adds to Hydra: campaign files as a configuration group, the user's folders first, two resolvers."""

from __future__ import annotations

from pathlib import Path

from hydra.core.config_search_path import ConfigSearchPath, SearchPathQuery
from hydra.core.object_type import ObjectType
from hydra.core.plugins import Plugins
from hydra.plugins.config_source import ConfigLoadError, ConfigResult, ConfigSource
from hydra.plugins.search_path_plugin import SearchPathPlugin
from omegaconf import OmegaConf

from hjcamp.configuration.search_path import campaign_folders, configuration_folders, packaged_root
from hjcamp.configuration.yaml_file import check_file
from hjcamp.errors import UsageError

GROUP = "campaign"


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
        check_file(file)
        content = OmegaConf.load(file)
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


class UserFoldersFirst(SearchPathPlugin):
    """Put the user's configuration and campaigns before ours, and our campaigns beside our configuration."""

    def manipulate_search_path(self, search_path: ConfigSearchPath) -> None:
        """Add the folders to Hydra's search path."""
        if not any(element.provider == "main" for element in search_path.get_path()):
            return
        for folder in campaign_folders():
            search_path.prepend("user", f"campaigns://{folder}", anchor="main")
        for folder in configuration_folders():
            search_path.prepend("user", f"file://{folder}", anchor="main")
        search_path.append("hjcamp", f"campaigns://{packaged_root() / 'campaigns'}", anchor=SearchPathQuery("main"))


def milli(value: float) -> float:
    """Return a thousandth: g to kg, mm to m."""
    return float(value) / 1000.0


def first(*values: object) -> object:
    """Return the first value that is not null."""
    return next((value for value in values if value is not None), None)


def register() -> None:
    """Make the plugins known to Hydra; harmless when repeated."""
    plugins = Plugins.instance()
    plugins.register(CampaignSource)
    plugins.register(UserFoldersFirst)
    OmegaConf.register_new_resolver("milli", milli, replace=True)
    OmegaConf.register_new_resolver("first", first, replace=True)


register()
