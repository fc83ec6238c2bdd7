"""The configurations behind the published values, and where that of a test differs from them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import yaml

from hjcamp.configuration.composer import Composer, as_override
from hjcamp.configuration.search_path import packaged_root
from hjcamp.controllers import load_controllers
from hjcamp.known_plants import OWN_PLANTS
from hjcamp.plants.pump_joint.published.values import CAMPAIGNS, CONDITION, cell_key
from hjcamp.report.runs.settings import difference

#: Parameters of controllers that came later; a log without them was made as by their defaults.
LATER = ("bumpless",)
#: Tables of the real joint: whatever models it, that is what its tests are held against.
MEASURED = ("5.4.1", "5.4.2", "5.5.1", "5.5.2")
UNKNOWN = "the log does not hold its configuration"


def standing(config: Mapping[str, Any], cell: tuple[str, ...]) -> list[dict[str, str]]:
    """Return, for each table that has the ``cell`` (of `cell_key`), its name and where ``config`` differs from its test.

    ``differs`` is empty where nothing that decides the physics does: only then the published value may stand next to it. What was
    measured stands next to every model of the joint that has a name of its own.
    """
    found = []
    for table, campaigns in CAMPAIGNS.items():
        published = [one for one in (_published(name, cell) for name in campaigns) if one is not None]
        if published:
            differs = _differs(_with_published_model(config, published[0]) if table in MEASURED else config, published[0])
            found.append({"table": table, "cell": " ".join(cell), "differs": differs})
    return found


def _with_published_model(config: Mapping[str, Any], published: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a configuration without its saved model; values that are set within the published one are another joint."""
    own, theirs = (one.get("model") for one in (config, published))
    named = isinstance(own, Mapping) and isinstance(theirs, Mapping) and own.get("name") != theirs.get("name")
    return {**config, "model": theirs} if named else config


def _differs(config: Mapping[str, Any], published: Mapping[str, Any]) -> str:
    if not config:
        return UNKNOWN
    found = difference(_completed(config), _completed(published))
    more = f", and {len(found) - 1} more" if len(found) > 1 else ""
    return f"{found[0]}{more}" if found else ""


def _completed(config: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a configuration whose controller has the parameters that a log from before they were known leaves to their defaults."""
    given = config.get("controller")
    if not isinstance(given, Mapping) or (law := load_controllers().get(str(given.get("name")))) is None:
        return config
    usual = {name: one.default for name, one in law.parameters.items() if name in LATER}
    return {**config, "controller": {**usual, **given}}


@lru_cache(maxsize=256)
def _published(campaign: str, key: tuple[str, ...]) -> dict[str, Any] | None:
    """Return the resolved configuration of the condition of a shipped campaign with these choices, None without one."""
    composer = _composer()
    for settings in conditions_of(campaign):
        if choices_of(settings) == key:
            config = composer.compose([as_override(name, value) for name, value in settings.items()]).config
            if not config.get("plant"):
                config["controller_model"] = composer.model(str(config["controller"].get("model")))
            return {name: value for name, value in config.items() if isinstance(value, Mapping)}
    return None


@lru_cache(maxsize=1)
def _composer() -> Composer:
    # Our own files alone: a user's group of the same name must not pass for the published one.
    root = packaged_root()
    folders = (
        "pkg://hydra.conf",
        f"file://{root / 'conf'}",
        f"campaigns://{root / 'campaigns'}",
        f"plants://{OWN_PLANTS}",
        "structured://",
    )
    return Composer(zip(("hydra", "main", "hjcamp", "plants", "schema"), folders, strict=True))


@lru_cache(maxsize=16)
def conditions_of(campaign: str) -> list[dict[str, Any]]:
    """Return the settings of every condition of a shipped campaign."""
    content = yaml.safe_load((packaged_root() / "campaigns" / f"{campaign}.yaml").read_text(encoding="utf-8"))
    axes = [
        list(values.values()) if isinstance(values, Mapping) else [{name: value} for value in values]
        for name, values in content["vary"].items()
    ]
    fixed = content.get("fixed") or {}
    return [{**fixed, **{k: v for case in cases for k, v in case.items()}} for cases in product(*axes)]


@lru_cache(maxsize=1)
def _chosen_by_default() -> dict[str, str]:
    content = yaml.safe_load(Path(packaged_root() / "conf" / "config.yaml").read_text(encoding="utf-8"))
    chosen = {group: name for one in content["defaults"] if isinstance(one, Mapping) for group, name in one.items()}
    return {group: str(chosen[group]) for group in CONDITION}


def choices_of(settings: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the choices that name the published cell of a condition with these settings."""
    return cell_key({**_chosen_by_default(), **{group: settings[group] for group in CONDITION if group in settings}})
