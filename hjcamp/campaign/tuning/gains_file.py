"""Gain sets as files of the group ``controller/gains``, with where they come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.storage import named_file, write_whole

FOLDER = Path("conf/controller/gains")


def free_place(name: str, replace: bool) -> Path:
    """Return where the gain set ``name`` goes; ``UsageError`` where it is there and not to be replaced, or no name."""
    [path] = named_file(name, "gain set", FOLDER)
    if path.exists() and not replace:
        raise UsageError(
            f"{path} exists; another name (--as NAME) or --replace is needed, or conditions=NAME leaves its case out"
        )
    return path


def write_gains(name: str, gains: Mapping[str, Mapping[str, float] | float], source: Sequence[str], replace: bool) -> Path:
    """Write ``conf/controller/gains/NAME.yaml`` in the working folder; ``source`` are lines that say where it is from.

    Raises ``UsageError`` where the file exists and is not to be replaced, or the name is none for a file.
    """
    path = free_place(name, replace)
    lines = ["# @package controller", *(f"# {line}" for line in source)]
    for side, group in gains.items():
        if not isinstance(group, Mapping):
            lines.append(f"{side}: {group:.4g}")
            continue
        lines.append(f"{side}: {{" + ", ".join(f"{key}: {value:.4g}" for key, value in group.items()) + "}")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, "\n".join(lines) + "\n")
    return path
