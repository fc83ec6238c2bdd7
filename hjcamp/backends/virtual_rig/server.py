"""The virtual device behind a socket of this computer or a pseudo-terminal: one client at a time, who knows the token."""

from __future__ import annotations

import errno
import json
import os
import secrets
import select
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hjcamp.backends.virtual_rig.device import LineClosed, VirtualDevice
from hjcamp.errors import HjcampError, UsageError
from hjcamp.rigs.line import SOCKET
from hjcamp.rigs.protocol import ERROR, LONGEST_LINE, message
from hjcamp.storage import user_folder

HOST = "127.0.0.1"
LOCAL_HOSTS = ("localhost", HOST)


def new_token() -> str:
    """Return a word that nobody guesses."""
    return secrets.token_hex(16)


def port_of(address: str) -> int:
    """Return the port of ``localhost:PORT``; raises ``UsageError`` for an address that other computers reach, or none."""
    host, _, number = address.rpartition(":")
    if host not in LOCAL_HOSTS or not number.isdigit() or int(number) > 65535:
        raise UsageError(
            f"address '{address}': localhost:PORT is needed; a virtual rig of a plant is served to this computer alone"
        )
    return int(number)


class Served:
    """A device that is served; ``port`` is where a client finds it."""

    def __init__(self, device: VirtualDevice, pty: bool = False, number: int = 0) -> None:
        self.device = device
        self._stop = threading.Event()
        self._busy = threading.Lock()
        if pty:
            self._terminal = _Terminal()
            self.port = self._terminal.name
            work: Callable[[], None] = lambda: self._talk(self._terminal.receive, self._terminal.send)  # noqa: E731
        else:
            self._listener = _listening(number)
            self.port = f"{SOCKET}{HOST}:{self._listener.getsockname()[1]}"
            work = self._accept
        self._thread = threading.Thread(target=work, name="virtual line", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End serving."""
        self._stop.set()
        self.device.close()
        if self.port.startswith(SOCKET):
            self._listener.close()
        else:
            self._terminal.close()
        self._thread.join(2.0)

    def _accept(self) -> None:
        while not self._stop.is_set():
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            threading.Thread(target=self._client, args=(client,), name="virtual line's client", daemon=True).start()

    def _client(self, client: socket.socket) -> None:
        with client:
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if not self._busy.acquire(blocking=False):
                with suppress(OSError):
                    client.sendall(message(ERROR, "another client is at work on this virtual rig"))
                return
            try:
                self._talk(lambda: client.recv(LONGEST_LINE), client.sendall)
            finally:
                self._busy.release()

    def _talk(self, receive: Callable[[], bytes], send: Callable[[bytes], object]) -> None:
        """Answer each line until the line ends, or one comes that has no end."""
        rest = b""
        with suppress(OSError, LineClosed):
            while not self._stop.is_set():
                found = receive()
                if not found and self.port.startswith(SOCKET):
                    return
                *lines, rest = (rest + found).split(b"\n")
                if len(rest) > LONGEST_LINE:
                    return
                for line in lines:
                    if answer := self.device.answer(line):
                        send(answer)
        if not self.port.startswith(SOCKET) and not self._stop.is_set():
            self._terminal.close()


class _Terminal:
    """A pseudo-terminal that its owner alone may open."""

    def __init__(self) -> None:
        try:
            import pty
            import tty
        except ImportError:
            raise UsageError("--pty: this system has no pseudo-terminals; leave it out") from None
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.name = os.ttyname(self._slave)
        os.chmod(self.name, 0o600)
        self._open = True

    def receive(self) -> bytes:
        """Return what has come, nothing where nothing does for a while."""
        ready, _, _ = select.select([self._master], [], [], 0.2)
        return os.read(self._master, LONGEST_LINE) if ready and self._open else b""

    def send(self, content: bytes) -> None:
        """Send bytes."""
        os.write(self._master, content)

    def close(self) -> None:
        """Close both ends: for the client the line is unplugged."""
        if self._open:
            self._open = False
            for one in (self._slave, self._master):
                with suppress(OSError):
                    os.close(one)


def _listening(number: int) -> socket.socket:
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        if os.name != "nt":
            found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        found.bind((HOST, number))
        found.listen(4)
    except OSError as error:
        found.close()
        why = "another program uses the port" if error.errno == errno.EADDRINUSE else error.strerror
        raise HjcampError(f"cannot serve on {HOST}:{number}: {why}; leave --address out to take a free one") from None
    return found


def ticket_path(plant: str) -> Path:
    """Return the file that says where a virtual rig of a plant is served; its owner alone may read it."""
    base = user_folder("XDG_STATE_HOME", ".local", "state")
    if base is None:
        raise UsageError("this user has no home folder to keep the address of a virtual rig in: set XDG_STATE_HOME to a folder")
    return base / "hjcamp" / "served_rigs" / f"{plant}.json"


@contextmanager
def ticket(served: Served) -> Iterator[Path]:
    """While open, ``rig=virtual`` finds the served rig."""
    path = ticket_path(served.device.plant.name)
    path.parent.mkdir(parents=True, exist_ok=True)
    content = {"port": served.port, "token": served.device.token, "process": os.getpid(), "rate": served.device.rate}
    part = path.with_name(f"{path.name}.{os.getpid()}")
    with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as stream:
        json.dump(content, stream)
    os.replace(part, path)
    try:
        yield path
    finally:
        with suppress(OSError, ValueError):
            if json.loads(path.read_text())["process"] == os.getpid():
                path.unlink()
