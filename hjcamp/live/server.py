"""The process of the page: reads messages from its standard input, serves browsers of this computer, ends with the run.

    python -m hjcamp.live.server PORT TITLE

The first line of standard output is the address, or ``error: REASON``. Nothing here can ask anything of the run.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import threading
import time
import traceback
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np

from hjcamp.live.messages import received
from hjcamp.live.state import Seen, State

HOST = "127.0.0.1"
LOWEST_PRIORITY = 10
# Browsers are told 25 times a second at most; a page without news hears from us, so that it knows that we live.
BETWEEN_EVENTS_S, SILENCE_S = 0.04, 5.0
STALLED_S = 10.0
MOST_BROWSERS = 16
LINGER_S = 5.0
BETWEEN_LOGS_S = 0.3


class PageServer(ThreadingHTTPServer):
    """Serves one page and its events to browsers of this computer."""

    daemon_threads = True
    # Elsewhere than on POSIX it would let two servers share a port.
    allow_reuse_address = os.name == "posix"

    def __init__(self, port: int, page: str, state: State) -> None:
        super().__init__((HOST, port), Handler)
        self.page = page.encode()
        self.state = state
        self.browsers = 0
        self.came = False


class Handler(BaseHTTPRequestHandler):
    """Answers one browser; it reads only."""

    server: PageServer
    timeout = STALLED_S

    def do_GET(self) -> None:
        """Serve the page, or its events as they come."""
        if self.headers.get("Host", "").rpartition(":")[0] not in (HOST, "localhost"):
            self.send_error(403, "this page is for this computer alone")
        elif self.path == "/":
            self._answer("text/html; charset=utf-8", self.server.page)
        elif self.path == "/events":
            self._events()
        else:
            self.send_error(404)

    def log_message(self, *words: Any) -> None:
        """Print nothing: the terminal is the run's."""

    def _answer(self, kind: str, content: bytes) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def _events(self) -> None:
        server = self.server
        if server.browsers >= MOST_BROWSERS:
            self.send_error(503, f"{MOST_BROWSERS} pages of this run are open already")
            return
        server.browsers += 1
        server.came = True
        try:
            self.send_response(200)
            self.send_header("Content-Type", "text/event-stream")
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self._tell(Seen())
        # the browser was closed, or does not read any more
        except OSError:
            pass
        finally:
            server.browsers -= 1

    def _tell(self, seen: Seen) -> None:
        state = self.server.state
        while True:
            with state.changed:
                state.changed.wait_for(lambda: not state.waits(seen), SILENCE_S)
                news, ended = state.news(seen), state.ended
            text = "".join(f"data: {json.dumps(one, allow_nan=False)}\n\n" for one in news)
            self.wfile.write((text or ": nothing new\n\n").encode())
            self.wfile.flush()
            if ended:
                return
            time.sleep(BETWEEN_EVENTS_S)


def read_messages(state: State, logs: LogReader) -> None:
    """Take in what the run says until it ends."""
    with contextlib.suppress(OSError, ValueError):
        for head, block in received(sys.stdin.buffer):
            # one message that cannot be shown must not hide those after it
            try:
                log = state.take(head, block)
            except Exception:
                traceback.print_exc()
                continue
            if log is not None:
                logs.ask(head, log)
    logs.close()
    state.end()


class LogReader(threading.Thread):
    """Shows finished tests from their logs: always the newest, a few a second; those in between are not shown."""

    def __init__(self, state: State) -> None:
        super().__init__(name="logs", daemon=True)
        self._state = state
        self._asked: tuple[dict[str, Any], Path] | None = None
        self._wake = threading.Event()
        self._closed = False

    def ask(self, head: dict[str, Any], log: Path) -> None:
        """Show this log when its turn comes."""
        self._asked = head, log
        self._wake.set()

    def close(self) -> None:
        """Show what was asked for last, and end."""
        self._closed = True
        self._wake.set()
        self.join(STALLED_S)

    def run(self) -> None:
        """Read one log after the other."""
        while not self._closed or self._asked:
            self._wake.wait()
            self._wake.clear()
            asked, self._asked = self._asked, None
            if asked is not None:
                # what cannot be read is not shown; the run itself says what is wrong with it
                with contextlib.suppress(Exception):
                    self._show(*asked)
                time.sleep(0.0 if self._closed else BETWEEN_LOGS_S)

    def _show(self, head: dict[str, Any], path: Path) -> None:
        from hjcamp.records.of_plant import period_of
        from hjcamp.records.read import read_log

        log = read_log(path)
        columns = dict(log.columns)
        count = len(columns["time_s"])
        columns["missed_samples"] = np.full(count, float(log.metadata.get("late_samples", 0)))
        first = int(np.searchsorted(columns["time_s"], -1e-9))
        self._state.show_log(head, columns, first, period_of(log.metadata, str(path)))


def main(port: int, title: str) -> int:
    """Serve until the run has ended and every browser has seen it; returns the exit code."""
    from hjcamp.live.page import page_html

    if hasattr(os, "nice"):
        os.nice(LOWEST_PRIORITY)
    state = State()
    try:
        server = PageServer(port, page_html(title), state)
    except (OSError, OverflowError) as error:
        print(f"error: {getattr(error, 'strerror', None) or error}", flush=True)
        return 1
    print(f"http://{HOST}:{server.server_address[1]}/", flush=True)
    threading.Thread(target=server.serve_forever, name="page", daemon=True).start()
    logs = LogReader(state)
    logs.start()
    read_messages(state, logs)
    until = time.monotonic() + LINGER_S
    while time.monotonic() < until and (server.browsers or not server.came):
        time.sleep(BETWEEN_EVENTS_S)
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2]))
