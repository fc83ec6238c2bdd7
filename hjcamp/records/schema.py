"""The protobuf message ``hjcamp.Sample``, described at run time."""

from __future__ import annotations

from functools import lru_cache

from hjcamp.records.log import FIELD_NAMES

SCHEMA_NAME = "hjcamp.Sample"
SCHEMA_ENCODING = "protobuf"


def field_number(name: str) -> int:
    """Return the protobuf number of a field: its place in the field table, from 1."""
    return FIELD_NAMES.index(name) + 1


@lru_cache(maxsize=32)
def descriptor_set(names: tuple[str, ...]) -> bytes:
    """Return the serialised FileDescriptorSet of a message that holds the fields ``names`` as doubles.

    Proto2 with optional fields: a zero is written and an absent field is known to be absent, whoever reads it.
    """
    from google.protobuf import descriptor_pb2

    file = descriptor_pb2.FileDescriptorProto(name="hjcamp/sample.proto", package="hjcamp")
    message = file.message_type.add(name="Sample")
    for name in names:
        message.field.add(
            name=name,
            number=field_number(name),
            type=descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE,
            label=descriptor_pb2.FieldDescriptorProto.LABEL_OPTIONAL,
        )
    return descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString(deterministic=True)
