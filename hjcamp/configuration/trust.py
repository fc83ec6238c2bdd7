"""What configuration may hold: values. What is run by Hydra (callbacks, launcher, sweeper) is named by our own files alone.

A configuration file comes from a colleague or a web page; a Python file in ``effects/`` says by its name what it is.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from omegaconf import DictConfig, OmegaConf, open_dict

from hjcamp.errors import UsageError

if TYPE_CHECKING:
    from hydra.core.override_parser.types import Override

# The keys by which a mapping of values becomes a call.
CALLS = ("_target_", "_args_", "_partial_")
HYDRA_MAY = (
    "hydra/launcher", "hydra/sweeper", "hydra.launcher", "hydra.sweeper", "hydra.sweep", "hydra.run.dir",
    "hydra.searchpath", "hydra.verbose",
)  # fmt: skip
#: What a reference in a file may call: an environment variable of whoever reads it is not among it.
RESOLVERS = ("milli", "first", "oc.select")
REFERENCES = (
    f"a reference is ${{KEY}}, or one of {', '.join(f'${{{name}:...}}' for name in RESOLVERS)}; on the command line any"
)
_REFERENCE = re.compile(r"\$\{\s*(?:(?P<call>[\w.]+)\s*:|[\w.@/\[\]-]+\s*(?P<end>\}))?")
_PARTS = re.compile(r"[\s./@:+~]+")


def check_file(path: Path, config: Any, package: str | None) -> None:
    """Raise ``UsageError`` where a configuration file names code, or reaches what belongs to Hydra; says file and line."""
    if package and _PARTS.split(package)[0] == "hydra":
        raise _refused(path, "@package", f"'@package {package}' reaches into 'hydra'")
    content = OmegaConf.to_container(config, resolve=False)
    for text in _texts(content):
        for found in _REFERENCE.finditer(text):
            if found["call"] is not None and found["call"] not in RESOLVERS:
                raise _refused(path, found[0], f"'{found[0]}' asks for what is not in the configuration", REFERENCES)
            if found["call"] is None and found["end"] is None:
                raise _refused(path, found[0], f"'{text[found.start() :][:40]}' is no plain reference", REFERENCES)
    for key in _keys(content):
        for call in CALLS:
            if call in _PARTS.split(key):
                raise _refused(path, call, f"'{call}' names code to run")
    if not isinstance(content, dict):
        return
    for name in content:
        key = str(name)
        if _PARTS.split(key)[0] == "hydra":
            raise _refused(path, key, f"'{key}' belongs to the program")
    for text in map(_entry, content.get("defaults") or []):
        if "hydra" in _PARTS.split(text):
            raise _refused(path, "hydra", f"'{text}' in its defaults reaches into 'hydra'")


def check_group(path: Path, config_path: str) -> None:
    """Raise ``UsageError`` for a file in the place of one of Hydra's own (a folder ``hydra``)."""
    if config_path.strip("/").split("/")[0] == "hydra":
        raise UsageError(f"{path}: configuration of 'hydra' is part of the program; remove this file")


def with_our_hydra(path: Path, config: Any, ours: Any) -> DictConfig:
    """Return a user's own ``config.yaml`` with our ``hydra``; one that holds another is refused."""
    if not isinstance(config, DictConfig):
        raise UsageError(f"{path}: a mapping of keys to values is needed")
    whole = config.copy()
    with open_dict(whole):
        if "hydra" in whole and whole.pop("hydra") != ours.hydra:
            raise _refused(path, "hydra", "'hydra' belongs to the program")
        of_hydra = [one for one in ours.defaults if "hydra" in _PARTS.split(_entry(one))]
        whole.defaults = [one for one in whole.get("defaults") or [] if one not in of_hydra]
        check_file(path, whole, None)
        whole.defaults = [*whole.defaults, *of_hydra]
        whole.hydra = ours.hydra
    return whole


def check_overrides(lines: Sequence[str], parse: Any) -> None:
    """Raise ``UsageError`` for an override that names code or sets more of Hydra than how and where a sweep runs."""
    doubtful = [line for line in lines if "hydra" in line or any(call in line for call in CALLS)]
    for item in parse(doubtful):
        _check_override(item)


def _check_override(item: Override) -> None:
    line = item.input_line
    key = item.key_or_group if item.package is None else f"{item.key_or_group}@{item.package}"
    value = None if item.is_delete() and item.value_type is None else item.value()
    for text in [key, *_keys(value)]:
        for call in CALLS:
            if call in _PARTS.split(text):
                raise UsageError(f"'{line}': '{call}' names code to run; overrides set values")
    if key == "hydra.mode":
        raise UsageError(f"'{line}': say -m for a sweep, and nothing for one run")
    if "hydra" in (_PARTS.split(key)[0], _PARTS.split(item.package or "")[0]) and not _allowed(key):
        raise UsageError(f"'{line}': this part of 'hydra' belongs to the program. Allowed: {', '.join(HYDRA_MAY)}")
    if key == "hydra.searchpath" and isinstance(value, list):
        for place in value:
            if re.match(r"(?!file:)\w+://", str(place)):
                raise UsageError(f"'{line}': only folders of configuration can be added, as --config-dir does")


def _allowed(key: str) -> bool:
    return any(key == one or key.startswith((one + ".", one + "/")) for one in HYDRA_MAY)


def _entry(entry: Any) -> str:
    """Return an entry of a defaults list as one text, ``override hydra/launcher: joblib``."""
    if isinstance(entry, Mapping):
        return ", ".join(f"{key}: {value}" for key, value in entry.items())
    return str(entry)


def _keys(content: Any) -> Iterator[str]:
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield str(getattr(key, "text", key))
            yield from _keys(value)
    elif isinstance(content, Iterable) and not isinstance(content, str | bytes):
        for value in content:
            yield from _keys(value)


def _texts(content: Any) -> Iterator[str]:
    if isinstance(content, str):
        yield content
    elif isinstance(content, Mapping | list | tuple):
        for value in content.values() if isinstance(content, Mapping) else content:
            yield from _texts(value)


def _refused(
    path: Path, word: str, reason: str, allowed: str = "a configuration file holds values only: take it out"
) -> UsageError:
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    line = next((number for number, text in enumerate(lines, 1) if word in text), None)
    where = f"{path}: line {line}" if line else str(path)
    return UsageError(f"{where}: {reason}; {allowed}")
