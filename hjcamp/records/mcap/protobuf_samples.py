"""Protobuf messages of any field layout, by the schema that the file carries, to columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from mcap import records

from hjcamp.errors import UsageError


class ProtobufDecoder:
    """Decodes the fields ``names`` by the FileDescriptorSet in ``schema``; raises UsageError where that is unusable.

    ``by_number``: the fields that are plain doubles, by protobuf number. ``implicit_zero``: fields of proto3
    without presence, whose zeros are not written.
    """

    def __init__(self, schema: records.Schema | None, names: Sequence[str], where: str) -> None:
        if schema is None or schema.encoding != "protobuf":
            found = "no schema" if schema is None else f"a schema in '{schema.encoding}'"
            raise UsageError(f"{where}: protobuf messages need a protobuf schema; the channel has {found}")
        self._message_class, descriptor, proto = message_type(schema, where)
        self.by_number: dict[int, str] = {}
        self.implicit_zero: frozenset[str] = frozenset()
        self._fields: list[tuple[str, bool]] = []
        for entry in proto.field:
            if entry.name not in names:
                continue
            if entry.label == entry.LABEL_REPEATED or not _is_number(entry):
                raise UsageError(f"{where}: field '{entry.name}' of the protobuf schema is not a single number")
            has_presence = bool(descriptor.fields_by_name[entry.name].has_presence)
            self._fields.append((entry.name, has_presence))
            if not has_presence:
                self.implicit_zero |= {entry.name}
            if entry.type == entry.TYPE_DOUBLE:
                self.by_number[entry.number] = entry.name

    def decode(
        self, messages: Sequence[bytes], first_sample: int, where: str
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Return per field the values and whether each was there, both of shape (messages,)."""
        from google.protobuf.message import DecodeError

        values = {name: np.zeros(len(messages)) for name, _ in self._fields}
        present = {name: np.ones(len(messages), dtype=bool) for name, _ in self._fields}
        for index, message in enumerate(messages):
            try:
                sample = self._message_class.FromString(message)
            except DecodeError as error:
                raise UsageError(
                    f"{where}: the message of sample {first_sample + index} is no {self._message_class.DESCRIPTOR.name}"
                ) from error
            for name, has_presence in self._fields:
                value = getattr(sample, name)
                values[name][index] = value
                present[name][index] = sample.HasField(name) if has_presence else value != 0
        return values, present


def message_type(schema: records.Schema, where: str) -> tuple[Any, Any, Any]:
    """Return the class, descriptor and description of a schema's messages; raises UsageError where it is unusable."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
    from google.protobuf.message import DecodeError

    try:
        files = descriptor_pb2.FileDescriptorSet.FromString(schema.data)
        pool = descriptor_pool.DescriptorPool()
        waiting = {file.name: file for file in files.file}
        while waiting:  # those that others are built on come first
            ready = [file for file in waiting.values() if waiting.keys().isdisjoint(file.dependency)]
            for file in ready or list(waiting.values()):
                pool.Add(waiting.pop(file.name))
        descriptor = pool.FindMessageTypeByName(schema.name)
        proto = descriptor_pb2.DescriptorProto()
        descriptor.CopyToProto(proto)
        return message_factory.GetMessageClass(descriptor), descriptor, proto
    except (DecodeError, KeyError, TypeError, ValueError, RecursionError) as error:
        raise UsageError(f"{where}: the protobuf schema '{schema.name}' cannot be used") from error


def _is_number(entry: Any) -> bool:
    return entry.type not in (
        entry.TYPE_STRING,
        entry.TYPE_BYTES,
        entry.TYPE_MESSAGE,
        entry.TYPE_GROUP,
        entry.TYPE_ENUM,
        entry.TYPE_BOOL,
    )
