"""One measurement of a carriage, as four other programs would have written it."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import polars
import yaml
from mcap.writer import Writer
from scipy.io import savemat

Columns = dict[str, np.ndarray]
FIELDS: dict[str, Any] = {
    "time_s": {"column": "t", "unit": "ms"},
    "position_m": {"column": "x", "unit": "mm", "sign": -1, "offset": 12.5},
    "voltage_v": {"column": "u", "scale": 2.5},
}
MAP: dict[str, Any] = {
    "plant": "axis",
    "fields": FIELDS,
    "metadata": {"condition": "{file}", "mass_kg": 95},
}


def measured(rows: int = 400, period: float = 1e-3) -> Columns:
    """Return what a logger of an axis wrote: ms, mm, raw volts; exact in ten digits, so that a text file holds it."""
    time = np.arange(rows) * period
    noise = np.random.default_rng(5).normal(0.0, 1e-2, rows)
    columns = {"t": 1e3 * time, "x": 50.0 * np.sin(time / period / 60.0) + noise, "u": np.cos(time / period / 60.0)}
    return {name: np.array([float(f"{one:.10g}") for one in values]) for name, values in columns.items()}


def write_map(folder: Path, **change: object) -> Path:
    """Write the map with changes of its keys; None leaves a key out."""
    path = folder / "map.yaml"
    path.write_text(yaml.safe_dump({key: value for key, value in (MAP | change).items() if value is not None}))
    return path


def write_csv(path: Path, columns: Columns) -> Path:
    """Write a table of text."""
    polars.DataFrame(columns).write_csv(path)
    return path


def write_parquet(path: Path, columns: Columns) -> Path:
    """Write a Parquet file."""
    polars.DataFrame(columns).write_parquet(path)
    return path


def write_mat(path: Path, columns: Columns) -> Path:
    """Write MATLAB variables as MATLAB has them: columns, a struct, a matrix."""
    savemat(path, {**columns, "data": {"x": columns["x"]}, "m": np.column_stack(list(columns.values())), "text": "no"})
    return path


def write_json_mcap(path: Path, columns: Columns, topic: str = "/motor/state", encoding: str = "json") -> Path:
    """Write JSON messages on a topic, one of them out of order, beside those of another topic."""
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    schema = writer.register_schema("state", "jsonschema", b"{}")
    other = writer.register_channel("/other", "json", schema)
    channel = writer.register_channel(topic, encoding, schema)
    order = [1, 0, *range(2, len(columns["t"]))]
    for index in order:
        sample = {name: float(values[index]) for name, values in columns.items()}
        message = sample | {"pose": {"x": sample["x"]}, "on": True}
        when = 10**18 + round(sample["t"] * 1e6)
        writer.add_message(other, when, b"{}", when)
        writer.add_message(channel, when, json.dumps(message).encode(), when)
    writer.finish()
    path.write_bytes(stream.getvalue())
    return path


def write_protobuf_mcap(path: Path, columns: Columns, topic: str = "/motor/state") -> Path:
    """Write protobuf messages whose position stands in a message of another file of the schema."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    inner = descriptor_pb2.FileDescriptorProto(name="pose.proto", package="lab", syntax="proto3")
    inner.message_type.add(name="Pose").field.add(name="x", number=1, type=1, label=1)
    outer = descriptor_pb2.FileDescriptorProto(name="state.proto", package="lab", syntax="proto3", dependency=["pose.proto"])
    message = outer.message_type.add(name="State")
    message.field.add(name="t", number=1, type=1, label=1)
    message.field.add(name="pose", number=2, type=11, label=1, type_name=".lab.Pose")
    message.field.add(name="u", number=40, type=1, label=1)
    pool = descriptor_pool.DescriptorPool()
    for file in (inner, outer):
        pool.Add(file)
    kind = message_factory.GetMessageClass(pool.FindMessageTypeByName("lab.State"))
    # The outer file first, as some programs write it.
    schema_data = descriptor_pb2.FileDescriptorSet(file=[outer, inner]).SerializeToString()
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    channel = writer.register_channel(topic, "protobuf", writer.register_schema("lab.State", "protobuf", schema_data))
    for index in range(len(columns["t"])):
        sample = kind(t=columns["t"][index], u=columns["u"][index])
        sample.pose.x = columns["x"][index]
        when = round(columns["t"][index] * 1e6)
        writer.add_message(channel, when, sample.SerializeToString(), when)
    writer.finish()
    path.write_bytes(stream.getvalue())
    return path
