"""The way to the device: the driver on this computer, a gRPC device server, or the virtual rig in this process."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from hjcamp.backends.rig.fault import RigUnavailable
from hjcamp.errors import UsageError
from hjcamp.json_text import json_values

CALL_TIMEOUT_S = 300.0  # a virtual rig may have to compile its kernel first: two and a half minutes on a busy computer
OWNER = uuid.uuid4().hex
_in_process: list[Any] = []


@dataclass(frozen=True)
class Connection:
    """``options`` for the vendor's client (None: the local driver), and what ends the connection."""

    options: Any
    close: Callable[[], None]


def in_process_channel() -> Any:
    """Return the channel to the virtual rig of this process; the rig is made on the first call."""
    if not _in_process:
        from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
        from hjcamp.plants.pump_joint.virtual_rig.in_process import InProcessChannel

        _in_process.append(InProcessChannel(VirtualDevice()))
    return _in_process[0]


def connect(config: Mapping[str, Any], seed: int | None) -> Connection:
    """Return the connection that ``rig.connection`` asks for.

    A virtual rig gets the joint of the test with this seed put on it; with None what is on it stays as it is.
    """
    given = config["rig"]["connection"]
    kind, address = given["kind"], given.get("address")
    if kind == "driver":
        _require_driver()
        return Connection(None, lambda: None)
    if kind == "address" and not address:
        raise UsageError("rig.connection.kind=address: rig.connection.address is missing, such as localhost:31763")
    from nidaqmx import GrpcSessionOptions

    if kind == "in_process":
        channel = in_process_channel()
        if seed is not None:
            _arrange(channel, config, seed)
        return Connection(GrpcSessionOptions(channel, ""), lambda: None)
    import grpc

    from hjcamp.backends.rig.deadline import KEEPALIVE, with_deadlines

    channel = grpc.insecure_channel(str(address), options=KEEPALIVE)
    try:
        _reach(channel, str(address))
        if given.get("virtual", True) and seed is not None:
            _arrange(channel, config, seed)
    except BaseException:
        channel.close()
        raise
    return Connection(GrpcSessionOptions(with_deadlines(channel), ""), channel.close)


def _require_driver() -> None:
    from nidaqmx.errors import DaqNotFoundError, Error
    from nidaqmx.system import System

    try:
        _ = System.local().driver_version
    except DaqNotFoundError:
        raise RigUnavailable(
            "the NI-DAQmx driver is not installed on this computer: install it (python -m nidaqmx installdriver), "
            "or use the virtual rig: rig=virtual"
        ) from None
    except (Error, OSError) as error:
        raise RigUnavailable(f"the NI-DAQmx driver does not answer: {error}") from error


def _reach(channel: Any, address: str) -> None:
    import grpc

    try:
        grpc.channel_ready_future(channel).result(timeout=5.0)
    except grpc.FutureTimeoutError:
        raise RigUnavailable(
            f"nothing answers at {address} (rig.connection.address); start one with: hjcamp rig serve"
        ) from None


def _arrange(channel: Any, config: Mapping[str, Any], seed: int) -> None:
    import grpc

    from hjcamp.plants.pump_joint.virtual_rig.bench import ARRANGE, as_bytes

    request = as_bytes({"config": dict(config), "seed": seed, "owner": OWNER})
    try:
        answer = json_values(channel.unary_unary(ARRANGE)(request, timeout=CALL_TIMEOUT_S), "the virtual rig's answer")
    except grpc.RpcError as error:
        if error.code() == grpc.StatusCode.UNIMPLEMENTED:
            raise UsageError(
                "the server at rig.connection.address is no virtual rig; for a real one: rig.connection.virtual=false"
            ) from None
        raise RigUnavailable(f"the virtual rig does not answer: {error.details()}") from None
    if "error" in answer:
        raise RigUnavailable(f"the virtual rig refuses: {answer['error']}")
