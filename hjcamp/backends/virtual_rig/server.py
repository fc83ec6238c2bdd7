"""The virtual rig behind a socket: lockstep virtual time, so that the speed of the connection does not matter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import grpc
from nidaqmx._stubs.nidaqmx_pb2_grpc import add_NiDAQmxServicer_to_server

from hjcamp.backends.virtual_rig.bench import bench_handler
from hjcamp.backends.virtual_rig.device import VirtualDevice
from hjcamp.backends.virtual_rig.faults import Fault
from hjcamp.backends.virtual_rig.servicer import VirtualServicer
from hjcamp.errors import HjcampError, UsageError

LOCAL_HOSTS = ("localhost", "127.0.0.1", "[::1]")


def check_address(address: str, anybody: bool = False) -> None:
    """Raise ``UsageError`` for an address that is none, or that other computers reach unless ``anybody`` may."""
    host, _, port = address.rpartition(":")
    if not host or not port.isdigit() or int(port) > 65535:
        raise UsageError(f"address '{address}': expected HOST:PORT such as localhost:31763")
    if host not in LOCAL_HOSTS and not anybody:
        raise UsageError(
            f"address '{address}': other computers can reach it, without a password; add --anybody if so wanted"
        )


def start_server(
    address: str = "localhost:0",
    faults: Iterable[Fault] = (),
    hidden: Mapping[str, Mapping[str, float]] | None = None,
) -> tuple[Any, int, VirtualDevice]:
    """Start serving on ``address`` (HOST:PORT, port 0 picks a free one); return server, port and device."""
    device = VirtualDevice(faults, hidden)
    server = grpc.server(ThreadPoolExecutor(max_workers=4), options=[("grpc.so_reuseport", 0)])
    add_NiDAQmxServicer_to_server(VirtualServicer(device), server)
    server.add_generic_rpc_handlers((bench_handler(device),))
    try:
        port = server.add_insecure_port(address)
    except RuntimeError as error:
        raise HjcampError(f"cannot serve on {address}: is another program using the port?") from error
    if port == 0:
        raise HjcampError(f"cannot serve on {address}: is another program using the port?")
    server.start()
    return server, port, device
