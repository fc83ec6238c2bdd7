"""What a person does at a real bench and no driver can: put a joint on it. One call next to the vendor's service."""

from __future__ import annotations

import json
from typing import Any

import grpc

from hjcamp.errors import HjcampError
from hjcamp.json_text import json_values
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice

SERVICE = "hjcamp.VirtualBench"
ARRANGE = f"/{SERVICE}/Arrange"


def as_bytes(content: Any) -> bytes:
    """Return plain values as JSON."""
    return json.dumps(content).encode()


def handle(device: VirtualDevice, request: bytes) -> bytes:
    """Arrange the joint of ``{"config": ..., "seed": ...}`` on the device; an answer with ``error`` refuses it."""
    try:
        asked = json_values(request, "what was asked")
        with device.lock:
            device.arrange(asked["config"], int(asked["seed"]), str(asked.get("owner", "")))
    except HjcampError as error:
        return as_bytes({"error": str(error)})
    except (KeyError, ValueError, TypeError, AttributeError, ArithmeticError) as error:
        return as_bytes({"error": f"cannot arrange this: {type(error).__name__}: {error}"})
    return as_bytes({})


def bench_handler(device: VirtualDevice) -> Any:
    """Return the gRPC handler of the bench."""

    def arrange(request: bytes, context: Any) -> bytes:
        return handle(device, request)

    return grpc.method_handlers_generic_handler(SERVICE, {"Arrange": grpc.unary_unary_rpc_method_handler(arrange)})
