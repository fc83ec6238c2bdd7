"""Deadlines of the calls to a device server: one that does not answer must not hold the client."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, NamedTuple, NoReturn

import grpc

ANSWER_S = 2.0  # beyond what the call itself may wait; a busy computer takes tenths of a second
SETUP_S = 5.0  # opening a device takes longer than using it
GRACE_S = 0.8  # for all calls together, once one was not answered
PAUSED_S = 0.3  # a deadline is noticed sooner, unless this process was stopped
IN_LOOP = ("GetReadAttributeUInt64", "ControlWatchdogTask")
# Pings only while a call waits, and rarer than servers complain about.
KEEPALIVE = (
    ("grpc.keepalive_time_ms", 10_000),
    ("grpc.keepalive_timeout_ms", 2_000),
    ("grpc.keepalive_permit_without_calls", 0),
)
SILENT = (grpc.StatusCode.DEADLINE_EXCEEDED, grpc.StatusCode.UNAVAILABLE)


class NoAnswer(grpc.RpcError):
    """What the vendor's client sees of a call whose deadline has passed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self._text = text

    def code(self) -> Any:
        """Return the status."""
        return grpc.StatusCode.DEADLINE_EXCEEDED

    def details(self) -> str:
        """Return the message."""
        return self._text

    def trailing_metadata(self) -> tuple[Any, ...]:
        """Return nothing: no server has said anything."""
        return ()

    def result(self, timeout: Any = None) -> NoReturn:
        """Raise it."""
        raise self


class _Details(NamedTuple):
    method: str
    timeout: float | None
    metadata: Any
    credentials: Any
    wait_for_ready: Any
    compression: Any


class Deadlines(grpc.UnaryUnaryClientInterceptor):
    """Gives every call a deadline. After one that was missed, all that follow share ``GRACE_S`` until one is answered."""

    def __init__(self) -> None:
        self._give_up_at: float | None = None

    def intercept_unary_unary(self, continuation: Callable[..., Any], details: Any, request: Any) -> Any:
        """Make one call."""
        start = time.monotonic()
        allowed = seconds_for(details.method, request) if details.timeout is None else details.timeout
        timeout = allowed
        if self._give_up_at is not None:
            timeout = min(allowed, max(self._give_up_at - start, 1e-3))
        answer = continuation(
            _Details(
                details.method,
                timeout,
                details.metadata,
                details.credentials,
                details.wait_for_ready,
                details.compression,
            ),
            request,
        )
        code = answer.code()
        if code not in SILENT:
            self._give_up_at = None
        elif self._give_up_at is None:
            self._give_up_at = time.monotonic() + GRACE_S
        if code is not grpc.StatusCode.DEADLINE_EXCEEDED:
            return answer
        if timeout < allowed:
            return NoAnswer("the device server does not answer")
        paused = time.monotonic() - start - timeout
        still = f" (this program itself stood still for {paused:.1f} s)" if paused > PAUSED_S else ""
        return NoAnswer(f"the device server did not answer within {timeout:.2g} s{still}")


def seconds_for(method: str | bytes, request: Any) -> float:
    """Return the deadline of a call, s: reading and writing wait for as long as they say themselves, and a little more."""
    name = (method.decode() if isinstance(method, bytes) else method).rpartition("/")[2]
    if name in IN_LOOP:
        return ANSWER_S
    own = getattr(request, "timeout", 0.0)
    if name.startswith(("Read", "Write")) and 0.0 <= own <= SETUP_S:
        return float(own) + ANSWER_S
    return SETUP_S


def with_deadlines(channel: Any) -> Any:
    """Return the channel with a deadline on every call."""
    return grpc.intercept_channel(channel, Deadlines())
