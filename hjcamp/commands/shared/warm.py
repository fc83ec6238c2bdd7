"""Compile in the background what the tour and every diagnosis need: one process at a time, which may be killed at any moment."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp import locks
from hjcamp.children import safe_children
from hjcamp.errors import HjcampError
from hjcamp.model.compile.kernel_cache import TEMPORARY, cache_folder

if TYPE_CHECKING:
    from rich.console import Console

LOCK = "compiling.lock"
NICE = 10
LOOK_EVERY_S = 2.0


def start() -> str:
    """Start the process unless one is at it, and return what is done in words; it goes where `HJCAMP_CACHE` says."""
    folder = cache_folder()
    if folder.parent.name.startswith(TEMPORARY):
        return "nothing is compiled in the background: the cache folder cannot be written"
    if number := at_work():
        return f"process {number} is compiling in the background already"
    # A session of its own: Ctrl-C is for this terminal, and the end of the terminal does not end it.
    own: dict[str, Any] = {"start_new_session": True}
    if os.name == "nt":
        own = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}  # type: ignore[attr-defined, unused-ignore]
    none = subprocess.DEVNULL
    with safe_children():
        process = subprocess.Popen([sys.executable, "-m", __name__], stdin=none, stdout=none, stderr=none, **own)
    # It ends long after this process, which does not wait for it.
    process.returncode = 0
    return (
        f"what hjcamp tour and every diagnosis need is compiled in the background, at low priority, by process {process.pid} "
        f"(kill {process.pid} stops it; nothing is lost)"
    )


def at_work() -> str:
    """Return the number of the process that compiles, empty where none does."""
    path = cache_folder() / LOCK
    with contextlib.suppress(OSError, UnicodeDecodeError):
        if locks.is_held(path):
            return path.read_text(encoding="utf-8").strip() or "another"
    return ""


@contextlib.contextmanager
def alone() -> Iterator[None]:
    """Wait until no other process compiles, then hold the lock."""
    path = cache_folder() / LOCK
    while (held := locks.take(path, f"{os.getpid()}\n")) is None:
        time.sleep(LOOK_EVERY_S)
    try:
        yield
    finally:
        locks.release(held)


def wait(console: Console) -> None:
    """Wait while a process in the background compiles what a diagnosis of the usual plant needs."""
    from hjcamp.effects import load_effects
    from hjcamp.known_plants import usual_plant

    number = at_work()
    missing = usual_plant().own_room("kernels").missing
    library = tuple(load_effects(plant=usual_plant()).values())
    if not number or not missing(library):
        return
    with console.status(f"process {number} is still compiling what this needs"):
        while at_work() and missing(library):
            time.sleep(LOOK_EVERY_S)


def main(folder: Path) -> None:
    """Compile what a diagnosis needs, then the rest."""
    from hjcamp.known_plants import usual_plant

    if hasattr(os, "nice"):
        os.nice(NICE)
    with contextlib.suppress(HjcampError, OSError), alone():
        for _ in usual_plant().own_room("kernels").warm(soon=True):
            if not folder.is_dir():
                return


if __name__ == "__main__":
    main(cache_folder())
