"""Open the page of a run: start its process, say where it is, show it to a browser where there is one."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import IO, Any

from hjcamp.children import safe_children
from hjcamp.errors import HjcampError, UsageError
from hjcamp.live.browser import has_windows, opened
from hjcamp.live.feed import GONE_S, Feed, feeding

STARTS_WITHIN_S = 60.0
HIGHEST_PORT = 65535


@dataclass(frozen=True)
class LiveAsk:
    """What was asked for: a port (0: any that is free) and whether a browser is opened."""

    port: int = 0
    browser: bool = True


@contextlib.contextmanager
def live_page(asked: LiveAsk, say: Callable[[str], None]) -> Iterator[None]:
    """While open, every run in this process has a page, from its first run on; ``say`` hears its address.

    That first run raises ``UsageError`` for a port that cannot be had, before anything is written.
    """
    opened: list[tuple[subprocess.Popen[bytes], Feed]] = []

    def feed() -> Feed:
        if not opened:
            process, address = _started(asked.port)
            assert process.stdin is not None
            opened.append((process, Feed(process.stdin)))
            say(f"live    {address}")
            if asked.browser:
                _show(address, say)
        return opened[0][1]

    try:
        with feeding(feed):
            yield
        if not opened:
            say("live    no run was made in this process (a sweep on another launcher has none here): no page was opened")
    except BaseException as error:
        for _, page in opened:
            page.say("stopped", str(error) or "interrupted")
        raise
    finally:
        for process, page in opened:
            page.close()
            _let_go(process)


def _started(port: int) -> tuple[subprocess.Popen[bytes], str]:
    # A session of its own: Ctrl-C is for the run, and the page ends when the run does.
    own: dict[str, Any] = {"start_new_session": True}
    if os.name == "nt":
        own = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}  # type: ignore[attr-defined, unused-ignore]
    command = [sys.executable, "-m", "hjcamp.live.server", str(port), "hjcamp run"]
    with safe_children():
        process = subprocess.Popen(
            command, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, **own
        )
    assert process.stdout is not None
    line = _first_line(process.stdout)
    if line.startswith("http://"):
        return process, line
    process.kill()
    process.communicate()
    reason = line.removeprefix("error: ") or "its process did not start"
    if not port:
        raise HjcampError(f"--live: no page: {reason}")
    raise UsageError(
        f"--live {port}: {reason[:1].lower()}{reason[1:]}; give another port, or --live alone for one that is free"
    )


def _first_line(stream: IO[bytes]) -> str:
    """Return the first line, empty where none comes in time."""
    found: list[bytes] = []
    reader = threading.Thread(target=lambda: found.append(stream.readline()), daemon=True)
    reader.start()
    reader.join(STARTS_WITHIN_S)
    return found[0].decode(errors="replace").strip() if found else ""


def _let_go(process: subprocess.Popen[bytes]) -> None:
    """Let the page end by itself: it waits a moment for browsers that have not seen the end yet."""
    assert process.stdout is not None
    process.stdout.close()
    # one that does not listen any more is ended
    if process.stdin is not None and not process.stdin.closed:
        process.kill()
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(GONE_S)
    # still there: it lingers, and this process ends without it
    process.returncode = 0 if process.returncode is None else process.returncode


def _show(address: str, say: Callable[[str], None]) -> None:
    """Open a browser that has windows of its own, from a thread: some do not return before they are closed."""
    if not has_windows():
        return

    def show() -> None:
        if not opened(address):
            say(f"        no browser could be opened; the page is at {address}")

    threading.Thread(target=show, name="browser", daemon=True).start()
