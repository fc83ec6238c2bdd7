"""Parts of configurations that every composer over our own files alone shares, as long as no file changes.

They are kept in the cache folder, a line of JSON each, for the calls to come: composing them takes half the time of a plan.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
from collections.abc import Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

from hydra.plugins.config_source import ConfigSource

from hjcamp.configuration.search_path import packaged_root
from hjcamp.configuration.variation import Loaded, Parts
from hjcamp.storage import user_folder

FOLDERS = ("file", "campaigns")
# What is composed depends on these as it does on the files.
MADE_BY = ("hydra-core", "omegaconf")
# Of a file of kept parts: there are some hundred of them, of some kB.
MOST_BYTES = 4_000_000
Part = tuple[Loaded, frozenset[str]]


class _Kept(Parts):
    """Parts by what they are composed of, those of earlier calls among them."""

    def __init__(self, file: Path) -> None:
        self._file = file
        lines: list[str] = []
        with suppress(OSError, UnicodeDecodeError):
            if file.stat().st_size <= MOST_BYTES:
                lines = file.read_text(encoding="utf-8").splitlines()
        for line in lines:
            with suppress(ValueError, LookupError, TypeError, RecursionError):  # half a line, or something else
                key, config, choices, changed = json.loads(line)
                super().__setitem__(tuple(key), (Loaded(dict(config), dict(choices)), frozenset(changed)))

    def __setitem__(self, key: tuple[str, ...], part: Part) -> None:
        super().__setitem__(key, part)
        loaded, changed = part
        content = [list(key), loaded.config, loaded.choices, sorted(changed)]
        with suppress(OSError, TypeError, ValueError):
            line = json.dumps(content) + "\n"
            # what JSON would change, such as a key that is a number, is composed in each call
            if json.loads(line) == content:
                self._file.parent.mkdir(parents=True, exist_ok=True)
                descriptor = os.open(self._file, os.O_WRONLY | os.O_APPEND | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o600)
                try:
                    # whole in one call: other processes write here, too
                    os.write(descriptor, line.encode())
                finally:
                    os.close(descriptor)


def parts_of(sources: Sequence[ConfigSource]) -> Parts:
    """Return what was composed of the files of these places as they are now; nothing yet where one of them is a user's."""
    folders = [Path(source.path) for source in sources if source.scheme() in FOLDERS]
    if not all(folder.resolve().is_relative_to(packaged_root()) for folder in folders):
        return {}
    return _parts(tuple(map(str, folders)), tuple(_files([*folders, Path(__file__).parent])))


def _files(folders: Sequence[Path]) -> list[tuple[str, int, int]]:
    """Return every file below the folders with its time of change and size."""
    found = []
    for folder in folders:
        for place, inside, names in os.walk(folder):
            inside[:] = [one for one in inside if one != "__pycache__"]
            for path in sorted(os.path.join(place, name) for name in names):
                state = os.lstat(path)
                found.append((path, state.st_mtime_ns, state.st_size))
    return found


@functools.lru_cache(maxsize=4)
def _parts(folders: tuple[str, ...], files: tuple[tuple[str, int, int], ...]) -> Parts:
    chosen = os.environ.get("HJCAMP_CACHE")
    cache = Path(chosen) if chosen else user_folder("XDG_CACHE_HOME", ".cache")
    if cache is None:
        return {}
    known = json.dumps([folders, files, [version(name) for name in MADE_BY]])
    name = hashlib.sha256(known.encode()).hexdigest()[:16]
    return _Kept((cache if chosen else cache / "hjcamp") / "composed" / f"{name}.jsonl")
