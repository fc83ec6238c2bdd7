"""The tasks of a client on the virtual rig: nobody else can use them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import grpc
import pytest
from nidaqmx import GrpcSessionOptions
from nidaqmx._stubs import nidaqmx_pb2 as messages
from nidaqmx._stubs.nidaqmx_pb2_grpc import NiDAQmxStub
from session_pb2 import Session

from hjcamp.errors import HjcampError
from hjcamp.plants.pump_joint.rig.connection import Connection
from hjcamp.plants.pump_joint.rig.tasks import RigTasks
from hjcamp.plants.pump_joint.rig.wiring import read_wiring
from hjcamp.plants.pump_joint.virtual_rig.bench import handle
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.server import start_server
from hjcamp.plants.pump_joint.virtual_rig.sessions import MOST_TASKS, RESERVED, DeviceError, Tasks


@pytest.fixture
def served() -> Iterator[tuple[int, VirtualDevice]]:
    server, port, device = start_server()
    yield port, device
    server.stop(0).wait()


def test_a_foreign_program_can_neither_write_nor_clear(compose: Any, served: tuple[int, VirtualDevice]) -> None:
    port, device = served
    device.arrange(compose(), 1, "the owner")
    with grpc.insecure_channel(f"localhost:{port}") as channel, grpc.insecure_channel(f"localhost:{port}") as other:
        tasks = RigTasks(read_wiring(compose()), Connection(GrpcSessionOptions(channel, ""), lambda: None), 0.1)
        tasks.write(1.0, 0.0, 0.5, 1e-3)
        before, foreign = dict(device.volts), NiDAQmxStub(other)
        names = [f"_unnamedTask<{number}>" for number in range(9)] + ["", "0", "1"]
        for name in names:
            task = Session(name=name)
            for call, request in (
                (foreign.WriteAnalogF64, messages.WriteAnalogF64Request(task=task, write_array=[9.0, 9.0, 9.0])),
                (foreign.ClearTask, messages.ClearTaskRequest(task=task)),
                (foreign.StopTask, messages.StopTaskRequest(task=task)),
                (foreign.ControlWatchdogTask, messages.ControlWatchdogTaskRequest(task=task)),
            ):
                with pytest.raises(grpc.RpcError, match="invalid or does not exist"):
                    call(request)
        with pytest.raises(grpc.RpcError, match="reserved"):
            foreign.CreateWatchdogTimerTaskEx(messages.CreateWatchdogTimerTaskExRequest(timeout=1e9))
        assert device.volts == before
        tasks.write(2.0, 0.0, 0.5, 1e-3)  # the owner's tasks are all there
        assert tasks.make_safe(0.0) is None
        tasks.close()
    assert device.tasks._tasks == {}


def test_a_refusal_does_not_give_a_session_away() -> None:
    tasks = Tasks()
    task = tasks.create("")
    tasks.add_channel(task.session, "ao", "Dev1/ao0")
    with pytest.raises(DeviceError) as caught:
        tasks.add_channel(tasks.create("").session, "ao", "Dev1/ao0")
    assert caught.value.code == RESERVED
    assert task.session not in str(caught.value)
    assert len({tasks.create("").session for _ in range(20)}) == 20


def test_names_and_tasks_are_bounded() -> None:
    tasks = Tasks()
    with pytest.raises(DeviceError, match="and no more"):
        tasks.create("x" * 1_000_000)
    for number in range(MOST_TASKS):
        tasks.create(f"task {number}")
    with pytest.raises(DeviceError, match="keeps 64 tasks"):
        tasks.create("")
    tasks.clear("task 0")
    tasks.create("")


def test_who_only_makes_tasks_keeps_nobody_out(compose: Any, served: tuple[int, VirtualDevice]) -> None:
    port, device = served
    with grpc.insecure_channel(f"localhost:{port}") as channel:
        stub = NiDAQmxStub(channel)
        for number in range(3):
            stub.CreateTask(messages.CreateTaskRequest(session_name=f"stranger {number}"))
    device.arrange(compose(), 1, "me")
    with pytest.raises(HjcampError, match="another client is at work"):
        device.arrange(compose(), 1, "another")


@pytest.mark.parametrize(
    "request_", [b"[" * 5_000, b'{"config": {}, "seed": 1e999}', b'{"config": [], "seed": 1}', b"[]", b"1"]
)
def test_what_cannot_be_arranged_is_refused(request_: bytes) -> None:
    assert "error" in json.loads(handle(VirtualDevice(), request_))
