"""Parts of configurations that every composer over our own files alone shares, as long as no file changes."""

from __future__ import annotations

import functools
import os
from collections.abc import Sequence
from pathlib import Path

from hydra.plugins.config_source import ConfigSource

from hjcamp.configuration.search_path import packaged_root
from hjcamp.configuration.variation import Parts

FOLDERS = ("file", "campaigns")


def parts_of(sources: Sequence[ConfigSource]) -> Parts:
    """Return what was composed of the files of these places as they are now; nothing yet where one of them is a user's."""
    folders = [Path(source.path) for source in sources if source.scheme() in FOLDERS]
    if not all(folder.resolve().is_relative_to(packaged_root()) for folder in folders):
        return {}
    return _parts(tuple(map(str, folders)), tuple(_files(folders)))


def _files(folders: Sequence[Path]) -> list[tuple[str, int, int]]:
    """Return every file below the folders with its time of change and size."""
    found = []
    for folder in folders:
        for place, _, names in os.walk(folder):
            for path in sorted(os.path.join(place, name) for name in names):
                state = os.lstat(path)
                found.append((path, state.st_mtime_ns, state.st_size))
    return found


@functools.lru_cache(maxsize=4)
def _parts(folders: tuple[str, ...], files: tuple[tuple[str, int, int], ...]) -> Parts:
    return {}
