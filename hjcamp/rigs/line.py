"""The line to a device: a serial port or a pseudo-terminal by pyserial, or a socket of this computer."""

from __future__ import annotations

import socket
import time
from typing import Any, Protocol

from hjcamp.errors import UsageError
from hjcamp.rigs.protocol import LONGEST_LINE

SOCKET = "socket://"


class Line(Protocol):
    """What carries messages: bytes out, and lines in until a moment of the monotonic clock."""

    def write(self, content: bytes) -> None:
        """Send bytes; raises ``OSError``."""

    def read_line(self, until: float) -> bytes:
        """Return the next whole line; raises ``TimeoutError`` and ``OSError``."""

    def close(self) -> None:
        """Let it go."""


class _Lines:
    """Cuts what arrives into lines."""

    def __init__(self) -> None:
        self._rest = b""

    def read_line(self, until: float) -> bytes:
        """Return the next whole line."""
        while b"\n" not in self._rest:
            left = until - time.monotonic()
            if left <= 0.0:
                raise TimeoutError("the device does not answer")
            if len(self._rest) > LONGEST_LINE:
                raise OSError("the device sends a line without end")
            self._rest += self._some(left)
        line, _, self._rest = self._rest.partition(b"\n")
        return line

    def _some(self, within: float) -> bytes:
        raise NotImplementedError


class SocketLine(_Lines):
    """A socket: ``socket://HOST:PORT``."""

    def __init__(self, connected: socket.socket) -> None:
        super().__init__()
        self._socket = connected
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connected.settimeout(1.0)

    def write(self, content: bytes) -> None:
        """Send bytes."""
        self._socket.settimeout(1.0)
        self._socket.sendall(content)

    def _some(self, within: float) -> bytes:
        self._socket.settimeout(within)
        found = self._socket.recv(LONGEST_LINE)
        if not found:
            raise OSError("the line was closed at its other end")
        return found

    def close(self) -> None:
        """Let it go."""
        self._socket.close()


class PortLine(_Lines):
    """A serial port, or a pseudo-terminal."""

    def __init__(self, port: Any) -> None:
        super().__init__()
        self._port = port

    def write(self, content: bytes) -> None:
        """Send bytes."""
        self._port.write(content)

    def _some(self, within: float) -> bytes:
        self._port.timeout = within
        return bytes(self._port.read(max(1, self._port.in_waiting)))

    def close(self) -> None:
        """Let it go."""
        self._port.close()


def open_line(port: str, baud: int, within: float) -> Line:
    """Return the line at ``port`` (``/dev/ttyACM0``, ``COM3``, ``socket://localhost:31764``); raises ``OSError``."""
    if port.startswith(SOCKET):
        host, _, number = port.removeprefix(SOCKET).rpartition(":")
        if not host or not number.isdigit() or int(number) > 65535:
            raise UsageError(f"port '{port}': socket://HOST:PORT is needed, such as socket://localhost:31764")
        return SocketLine(socket.create_connection((host.strip("[]"), int(number)), timeout=within))
    try:
        import serial
    except ImportError:
        raise UsageError(f"port '{port}': a serial line needs pyserial: pip install 'hjcamp[serial]'") from None
    return PortLine(serial.Serial(port, baud, timeout=within, write_timeout=within, exclusive=True))
