"""The protobuf message ``hjcamp.Sample``, described at run time."""

from __future__ import annotations

from functools import lru_cache

SCHEMA_NAME = "hjcamp.Sample"
SCHEMA_ENCODING = "protobuf"


@lru_cache(maxsize=32)
def descriptor_set(fields: tuple[tuple[str, int], ...]) -> bytes:
    """Return the serialised FileDescriptorSet of a message that holds ``fields`` (name, number) as doubles.

    Proto2 with optional fields: a zero is written and an absent field is known to be absent, whoever reads it.
    """
    from google.protobuf import descriptor_pb2

    file = descriptor_pb2.FileDescriptorProto(name="hjcamp/sample.proto", package="hjcamp")
    message = file.message_type.add(name="Sample")
    for name, number in fields:
        message.field.add(
            name=name,
            number=number,
            type=descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE,
            label=descriptor_pb2.FieldDescriptorProto.LABEL_OPTIONAL,
        )
    return bytes(descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString(deterministic=True))
