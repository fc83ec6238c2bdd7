"""The virtual rig behind a socket: in lockstep virtual time, or with time that passes by itself."""

from __future__ import annotations

import errno
import socket
import sys
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import grpc
from nidaqmx._stubs.nidaqmx_pb2_grpc import add_NiDAQmxServicer_to_server

from hjcamp.errors import HjcampError, UsageError
from hjcamp.plants.pump_joint.virtual_rig.bench import bench_handler
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.faults import Fault
from hjcamp.plants.pump_joint.virtual_rig.servicer import VirtualServicer

LOCAL_HOSTS = ("localhost", "127.0.0.1", "[::1]")
EVERYWHERE = ("0.0.0.0", "[::]")
WINDOWS = sys.platform == "win32"
OPTIONS = (("grpc.so_reuseport", 0), ("grpc.http2.min_recv_ping_interval_without_data_ms", 5_000))


def split_address(address: str) -> tuple[str, int]:
    """Return host and port of ``HOST:PORT``; raises ``UsageError`` for anything else."""
    host, _, port = address.rpartition(":")
    if host in ("", "*") or not port.isdigit() or int(port) > 65535:
        raise UsageError(f"address '{address}': expected HOST:PORT such as localhost:31763")
    return host, int(port)


def is_local(address: str) -> bool:
    """Return whether no other computer can reach an address."""
    return split_address(address)[0] in LOCAL_HOSTS


def check_address(address: str, anybody: bool = False) -> None:
    """Raise ``UsageError`` for an address that is none, or that other computers reach unless ``anybody`` may."""
    if not is_local(address) and not anybody:
        raise UsageError(f"address '{address}': other computers can reach it, without a password; add --anybody if so wanted")


def client_address(address: str, port: int) -> str:
    """Return the address that a client uses: that of this computer where the server listens everywhere."""
    host, _ = split_address(address)
    return f"{socket.gethostname() if host in EVERYWHERE else host}:{port}"


def check_free(address: str) -> None:
    """Raise ``HjcampError`` where nobody can listen on an address; gRPC itself would print pages about it."""
    host, port = split_address(address)
    try:
        found = socket.getaddrinfo(host.strip("[]"), port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    except OSError as error:
        raise HjcampError(f"cannot serve on {address}: {error.strerror}; serve on localhost:{port}") from None
    refused: list[OSError] = []
    for family, kind, protocol, _, place in found:
        try:
            with socket.socket(family, kind, protocol) as trial:
                if not WINDOWS:
                    trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                trial.bind(place)
        except OSError as error:
            refused.append(error)
            if error.errno == errno.EADDRINUSE:
                raise HjcampError(
                    f"cannot serve on {address}: another program, perhaps another `hjcamp rig serve`, uses the port; "
                    f"end it, or take another one: --address {host}:{port + 1 if port < 65535 else port - 1}"
                ) from None
    if len(refused) == len(found):
        raise HjcampError(f"cannot serve on {address}: {refused[0].strerror}; serve on localhost:31763")


def start_server(
    address: str = "localhost:0",
    faults: Iterable[Fault] = (),
    hidden: Mapping[str, Mapping[str, float]] | None = None,
    rate: float | None = None,
    report: Callable[[str], None] = lambda text: None,
) -> tuple[Any, int, VirtualDevice]:
    """Start serving on ``address`` (HOST:PORT, port 0 picks a free one); return server, port and device.

    ``rate``: seconds of the plant for each second of the wall clock, None for lockstep; ``report`` hears of the watchdog.
    """
    check_free(address)
    device = VirtualDevice(faults, hidden, rate, report)
    server = grpc.server(ThreadPoolExecutor(max_workers=4), options=OPTIONS)
    add_NiDAQmxServicer_to_server(VirtualServicer(device), server)
    server.add_generic_rpc_handlers((bench_handler(device),))
    try:
        port = server.add_insecure_port(address)
    except RuntimeError as error:
        device.close()
        raise HjcampError(f"cannot serve on {address}: {error}") from error
    server.start()
    return server, port, device
