"""Other processes that compile kernels which are needed soon, while this one works with those that are there.

Each is given kernels' files in the cache folder, one a line, and ends when its input does.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import subprocess
import sys
import types
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.children import safe_children
from hjcamp.model.compile import kernel_cache
from hjcamp.model.compile.kernel import shared_source

# Each takes some hundred megabytes.
MOST = 2
_asked: list[str] = []
_running: list[subprocess.Popen[bytes]] = []


def compile_ahead(sources: Sequence[str]) -> None:
    """Let other processes compile kernels that run free, in turns, if no process has compiled them.

    Where there is none, or no folder for what it compiles, each is compiled where it is first needed.
    """
    missing = [one for one in sources if one not in _asked and not kernel_cache.is_compiled(one, "run_free")]
    if not missing:
        return
    for source in missing:
        _asked.append(source)
        with contextlib.suppress(OSError):
            file = kernel_cache.written_file(source)
            into = _next((len(_asked) - 1) % MOST).stdin
            assert into is not None
            into.write(f"{file}\n".encode())
            into.flush()


def _next(place: int) -> subprocess.Popen[bytes]:
    """Return the process whose turn it is; one that is not there, or has ended, is started."""
    if place >= len(_running):
        place = len(_running)
        _running.append(_started())
    elif _running[place].poll() is not None:
        _running[place] = _started()
    return _running[place]


def _started() -> subprocess.Popen[bytes]:
    # A session of its own: Ctrl-C is for the work, and this process ends when that does.
    own: dict[str, Any] = {"start_new_session": True}
    if os.name == "nt":
        own = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}  # type: ignore[attr-defined, unused-ignore]
    command = [sys.executable, "-m", "hjcamp.model.compile.compiled_ahead"]
    with safe_children():
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **own)
    atexit.register(process.kill)
    return process


def compile_free(kernel: types.ModuleType) -> None:
    """Compile what runs a model free, for the arrays that a simulator gives it."""
    from numba import typeof

    line, table, whole = np.zeros(1), np.zeros((1, 1)), np.zeros(1, dtype=np.int64)
    given = (line, line, line, whole, table, table, 1.0, whole, line, table, table, table, table, table, table)
    kernel.run_free.compile(tuple(typeof(one) for one in given))


def main() -> None:
    """Compile the kernels that standard input names, until it ends or who asked for them is gone."""
    who = os.getppid()
    kernel_cache.load_kernel(shared_source())
    for line in sys.stdin.buffer:
        if os.getppid() != who:
            break
        # what cannot be compiled here is told where it is needed
        with contextlib.suppress(Exception):
            compile_free(kernel_cache.load_written(Path(line.decode().rstrip("\n"))))


if __name__ == "__main__":
    main()
