"""A server and a client in processes of their own, for what happens when one of them stops, dies, or is cut off."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import hjcamp

PATIENCE_S = 90.0  # for what a loaded computer does before it comes to the point
CALL = (sys.executable, "-m", "hjcamp")


@contextmanager
def program(arguments: Sequence[str], folder: Path) -> Iterator[subprocess.Popen[str]]:
    """Run ``hjcamp ARGUMENTS`` in ``folder`` with its output in ``out.txt`` and ``err.txt``; it is killed in the end."""
    environment = {**os.environ, "PYTHONPATH": str(Path(hjcamp.__file__).parents[1]), "TMPDIR": str(folder)}
    environment.pop("HJCAMP_CONF", None)
    folder.mkdir(exist_ok=True)
    with open(folder / "out.txt", "w") as out, open(folder / "err.txt", "w") as err:
        process = subprocess.Popen([*CALL, *arguments], cwd=folder, stdout=out, stderr=err, text=True, env=environment)
        try:
            yield process
        finally:
            with suppress(ProcessLookupError):
                process.send_signal(signal.SIGCONT)
            process.kill()
            process.wait()


@contextmanager
def served_rig(folder: Path, *arguments: str) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """Serve a virtual rig in a process of its own; give that and the port."""
    with program(["rig", "serve", "--address", "localhost:0", *arguments], folder) as process:
        said = folder / "out.txt"
        wait_until(lambda: "served at" in said.read_text(), process)
        found = re.search(r"served at localhost:(\d+)", said.read_text())
        assert found is not None
        yield process, int(found[1])


def wait_until(happened: Callable[[], bool], process: subprocess.Popen[str] | None = None) -> None:
    """Wait for something; raises where it does not happen, or where the process that should do it has ended."""
    end = time.monotonic() + PATIENCE_S
    while not happened():
        assert time.monotonic() < end, "it did not happen"
        assert process is None or process.poll() is None, "the process has ended"
        time.sleep(0.002)


def connection(port: int) -> str:
    """Return the override for a rig behind a port of this computer."""
    return f"rig.connection={{kind:address,address:'localhost:{port}'}}"


class Cable:
    """A way from a port of this computer to the server, which can be cut: from then on nothing arrives, nothing ends."""

    def __init__(self, port: int) -> None:
        self._server = port
        self._cut = threading.Event()
        self._listener = socket.create_server(("localhost", 0))
        self._ends: list[socket.socket] = []
        self.port = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        """Let nothing through from now on."""
        self._cut.set()

    def mend(self) -> None:
        """Let new connections through again; those that were cut stay so."""
        self._cut = threading.Event()

    def close(self) -> None:
        """Give the sockets free."""
        self.cut()
        for end in (self._listener, *self._ends):
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                client, _ = self._listener.accept()
                self._ends.append(client)
                if self._cut.is_set():
                    continue
                server = socket.create_connection(("localhost", self._server))
                self._ends.append(server)
                for source, target in ((client, server), (server, client)):
                    source.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    threading.Thread(target=self._carry, args=(source, target, self._cut), daemon=True).start()

    def _carry(self, source: socket.socket, target: socket.socket, cut: threading.Event) -> None:
        with suppress(OSError):
            while data := source.recv(65536):
                if cut.is_set():
                    return
                target.sendall(data)
        with suppress(OSError):
            if not cut.is_set():
                target.shutdown(socket.SHUT_RDWR)
