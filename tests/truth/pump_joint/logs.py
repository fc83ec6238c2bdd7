"""Test logs as another logger writes them: JSON messages in MCAP, a JSON schema, sparse metadata."""

import json
import os
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType, Writer

TOPIC = "/test/sample"
CLOCK_START_NS = 1_760_000_000_000_000_000


def write_log(path: Path, columns: list[str], rows: np.ndarray, metadata: dict[str, str]) -> None:
    """Write one test, rows of shape (n, len(columns)) in the contract's units, under its final name at once."""
    properties = {name: {"type": "number"} for name in columns}
    schema = json.dumps({"type": "object", "properties": properties}).encode()
    template = "{" + ", ".join(f'"{name}": %r' for name in columns) + "}"
    values = (np.round(rows, 6) + 0.0).tolist()
    partial = path.with_suffix(path.suffix + ".part")
    with partial.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start(profile="", library="bench rig logger")
        schema_id = writer.register_schema(name="hjcamp.Sample", encoding="jsonschema", data=schema)
        channel_id = writer.register_channel(topic=TOPIC, message_encoding="json", schema_id=schema_id)
        begin = rows[0, 0]
        for index, row in enumerate(values):
            stamp = CLOCK_START_NS + round((rows[index, 0] - begin) * 1e9)
            data = (template % tuple(row)).encode()
            writer.add_message(channel_id, log_time=stamp, data=data, publish_time=stamp)
        writer.add_metadata(name="hjcamp.test", data=metadata)
        writer.finish()
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(partial, path)
