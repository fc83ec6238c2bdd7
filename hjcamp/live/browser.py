"""A browser that has windows of its own, where this computer can show one."""

from __future__ import annotations

import contextlib
import os
import sys


def has_windows() -> bool:
    """Return whether a browser could open a window here; one in a terminal is no such browser."""
    if os.name != "posix" or sys.platform == "darwin":
        return True
    return any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"))


def opened(address: str) -> bool:
    """Open an address in the browser; returns whether one took it. Some do not return before they are closed."""
    import webbrowser

    with contextlib.suppress(webbrowser.Error, OSError):
        return webbrowser.open(address)
    return False
