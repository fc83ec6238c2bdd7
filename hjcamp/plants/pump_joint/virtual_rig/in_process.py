"""A gRPC channel that ends in this process: the vendor's client code runs unchanged, without a socket."""

from __future__ import annotations

from typing import Any, NoReturn

import grpc

from hjcamp.plants.pump_joint.virtual_rig.bench import ARRANGE, handle
from hjcamp.plants.pump_joint.virtual_rig.device import VirtualDevice
from hjcamp.plants.pump_joint.virtual_rig.servicer import VirtualServicer


class InProcessError(grpc.RpcError):
    """What a client sees of a call that was aborted."""

    def __init__(self, code: Any, details: str, metadata: tuple[Any, ...]) -> None:
        super().__init__(details)
        self._code, self._details, self._metadata = code, details, metadata

    def code(self) -> Any:
        """Return the status."""
        return self._code

    def details(self) -> str:
        """Return the message."""
        return self._details

    def trailing_metadata(self) -> tuple[Any, ...]:
        """Return the metadata that carries the driver's error code."""
        return self._metadata


class _Entry(tuple[str, str]):
    @property
    def key(self) -> str:
        return self[0]

    @property
    def value(self) -> str:
        return self[1]


class _Context:
    def __init__(self) -> None:
        self._metadata: tuple[Any, ...] = ()

    def is_active(self) -> bool:
        return True

    def set_trailing_metadata(self, metadata: tuple[tuple[str, str], ...]) -> None:
        self._metadata = tuple(_Entry(entry) for entry in metadata)

    def abort(self, code: Any, details: str) -> NoReturn:
        raise InProcessError(code, details, self._metadata)


class InProcessChannel(grpc.Channel):
    """Calls the servicer directly; messages pass as they are."""

    def __init__(self, device: VirtualDevice) -> None:
        self.device = device
        self.servicer = VirtualServicer(device)

    def unary_unary(self, method: str, *serializers: Any, **options: Any) -> Any:
        """Return the function that makes one call."""
        if method == ARRANGE:
            return lambda request, **options: handle(self.device, request)
        target = getattr(self.servicer, method.rpartition("/")[2])

        def invoke(request: Any, timeout: Any = None, metadata: Any = None, **options: Any) -> Any:
            context = _Context()
            try:
                return target(request, context)
            except NotImplementedError as error:
                raise InProcessError(grpc.StatusCode.UNIMPLEMENTED, f"{method}: {error}", ()) from None

        return invoke

    def unary_stream(self, method: str, *serializers: Any, **options: Any) -> Any:
        """Return a call that is not served."""
        return None

    stream_unary = unary_stream
    stream_stream = unary_stream

    def subscribe(self, callback: Any, try_to_connect: bool = False) -> None:
        """Do nothing: there is no connection."""

    def unsubscribe(self, callback: Any) -> None:
        """Do nothing: there is no connection."""

    def close(self) -> None:
        """Do nothing: there is no connection."""

    def __enter__(self) -> InProcessChannel:
        return self

    def __exit__(self, *raised: object) -> None:
        return None
