"""The deadline of each call, and what is left of it once a server is silent."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any

import grpc
import pytest

from hjcamp.backends.rig import deadline as rig_deadline
from hjcamp.backends.rig.deadline import ANSWER_S, GRACE_S, SETUP_S, Deadlines, seconds_for

DETAILS = SimpleNamespace(timeout=None, metadata=None, credentials=None, wait_for_ready=None, compression=None)
READ = SimpleNamespace(timeout=0.1)


class Server:
    """Answers every call with a status, and keeps the deadlines."""

    def __init__(self) -> None:
        self.status = grpc.StatusCode.OK
        self.deadlines: list[float] = []
        self.takes = 0.0

    def __call__(self, details: Any, request: Any) -> Any:
        self.deadlines.append(details.timeout)
        time.sleep(self.takes)
        return SimpleNamespace(code=lambda: self.status)


def call(deadlines: Deadlines, server: Server, name: str = "ReadAnalogF64", request: Any = READ) -> Any:
    DETAILS.method = f"/nidaqmx_grpc.NiDAQmx/{name}"
    return deadlines.intercept_unary_unary(server, DETAILS, request)


@pytest.mark.parametrize(
    ("name", "own", "seconds"),
    [
        ("ReadAnalogF64", 0.1, 0.1 + ANSWER_S),
        ("WriteAnalogF64", 0.1, 0.1 + ANSWER_S),
        ("ReadAnalogF64", -1.0, SETUP_S),  # the driver would wait for ever
        ("ReadAnalogF64", 1e9, SETUP_S),
        ("ControlWatchdogTask", None, ANSWER_S),
        ("GetReadAttributeUInt64", None, ANSWER_S),
        ("CreateWatchdogTimerTaskEx", 0.005, SETUP_S),
        ("StartTask", None, SETUP_S),
    ],
)
def test_every_call_has_a_deadline(name: str, own: float | None, seconds: float) -> None:
    request = SimpleNamespace() if own is None else SimpleNamespace(timeout=own)
    assert seconds_for(f"/nidaqmx_grpc.NiDAQmx/{name}", request) == pytest.approx(seconds)
    assert seconds_for(f"/nidaqmx_grpc.NiDAQmx/{name}".encode(), request) == pytest.approx(seconds)


@pytest.mark.parametrize("status", [grpc.StatusCode.DEADLINE_EXCEEDED, grpc.StatusCode.UNAVAILABLE])
def test_all_calls_after_a_missed_one_share_the_grace(status: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(rig_deadline, "time", SimpleNamespace(monotonic=lambda: now[0]))
    server, deadlines = Server(), Deadlines()
    server.status = status
    call(deadlines, server)
    for passed, left in ((0.0, GRACE_S), (0.3, GRACE_S - 0.3), (GRACE_S, 1e-3), (60.0, 1e-3)):
        now[0] = 100.0 + passed
        call(deadlines, server, "StopTask", SimpleNamespace())
        assert server.deadlines[-1] == pytest.approx(left)
    server.status = grpc.StatusCode.UNKNOWN  # an answer, though an error of the device
    call(deadlines, server)
    call(deadlines, server)
    assert server.deadlines[-1] == pytest.approx(0.1 + ANSWER_S)


def test_what_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    server, deadlines = Server(), Deadlines()
    server.status = grpc.StatusCode.DEADLINE_EXCEEDED
    monkeypatch.setattr(rig_deadline, "ANSWER_S", -0.05)
    server.takes = 0.5  # the deadline is after 0.05 s: somebody stopped this process
    missed = call(deadlines, server)
    assert missed.details().startswith("the device server did not answer within 0.05 s (this program itself stood still")
    with pytest.raises(grpc.RpcError):
        missed.result()
    server.takes = 0.0
    time.sleep(GRACE_S)
    assert call(deadlines, server).details() == "the device server does not answer"
