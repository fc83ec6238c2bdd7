"""Start other Python processes so that they import what is installed, and nothing that lies in the working folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SAFE = "PYTHONSAFEPATH"


def keep_children_safe() -> None:
    """Let every Python that this process starts from now on leave the working folder out of its path of modules.

    In a checkout of this program that is its own folder, from which it may be running without being installed.
    """
    if Path(__file__).resolve().parents[1] != Path.cwd():
        os.environ[SAFE] = "1"


@contextmanager
def safe_children() -> Iterator[None]:
    """Do as `keep_children_safe` while processes are started in here: a notebook's own processes stay as they are."""
    before = os.environ.get(SAFE)
    keep_children_safe()
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(SAFE, None)
