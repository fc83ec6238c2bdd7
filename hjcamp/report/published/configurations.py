"""The configurations behind the published values, and where that of a test differs from them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import yaml

from hjcamp.configuration.composer import Composer, as_override
from hjcamp.configuration.search_path import packaged_root
from hjcamp.controllers import load_controllers
from hjcamp.plants import OWN_PLANTS
from hjcamp.report.published import CONDITION, cell_key

#: The campaigns whose conditions are the tests of a published table.
CAMPAIGNS = {
    "5.4.1": ("controllers",),
    "5.4.2": ("controllers",),
    "5.5.1": ("robustness_horizontal", "robustness_vertical"),
    "5.5.2": ("robustness_horizontal", "robustness_vertical"),
    "5.6.1": ("friction_compliance",),
    "5.3.2": ("feedforward_simulation",),
    "6.3.1": ("previous_joint",),
}
#: What does not decide the physics of a test: who carries it out, how often, and with which draws.
NO_PHYSICS = ("backend", "rig", "repetitions", "seed")
#: Parameters of controllers that came later; a log without them was made as by their defaults.
LATER = ("bumpless",)
UNKNOWN = "the log does not hold its configuration"
ABSENT: Any = object()


def standing(config: Mapping[str, Any], cell: tuple[str, ...]) -> list[dict[str, str]]:
    """Return, for each table that has the ``cell`` (of `cell_key`), its name and where ``config`` differs from its test.

    ``differs`` is empty where nothing that decides the physics does: only then the published value may stand beside.
    """
    found = []
    for table, campaigns in CAMPAIGNS.items():
        published = [one for one in (_published(name, cell) for name in campaigns) if one is not None]
        if published:
            found.append({"table": table, "cell": " ".join(cell), "differs": _differs(config, published[0])})
    return found


def difference(config: Mapping[str, Any], published: Mapping[str, Any]) -> list[str]:
    """Return where a resolved configuration differs from a published one, in words; nothing where the physics is equal.

    A group with another name counts once: ``pump is pump1 instead of pump2``.
    """
    found = []
    for group in dict.fromkeys((*published, *config)):
        if group in NO_PHYSICS:
            continue
        pairs = unequal(_completed(group, config.get(group)), _completed(group, published.get(group)), group)
        names = next(((ours, theirs) for key, ours, theirs in pairs if key == f"{group}.name"), None)
        parts = [_in_words(key, ours, theirs) for key, ours, theirs in pairs if key != f"{group}.name"]
        if parts and names:
            parts = [_in_words(group, *names)]
        found += parts
    return found


def _completed(group: str, given: Any) -> Any:
    """Return a controller with the parameters that a log from before they were known leaves to their defaults."""
    if group != "controller" or not isinstance(given, Mapping):
        return given
    law = load_controllers().get(str(given.get("name")))
    usual = {name: one.default for name, one in law.parameters.items() if name in LATER} if law else {}
    return {**usual, **given}


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


def _differs(config: Mapping[str, Any], published: Mapping[str, Any]) -> str:
    if not config:
        return UNKNOWN
    found = difference(config, published)
    more = f", and {len(found) - 1} more" if len(found) > 1 else ""
    return f"{found[0]}{more}" if found else ""


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
        "pkg://hydra.conf", f"file://{root / 'conf'}", f"campaigns://{root / 'campaigns'}", f"plants://{OWN_PLANTS}",
        "structured://",
    )  # fmt: skip
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
