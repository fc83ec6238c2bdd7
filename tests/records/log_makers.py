"""Logs for the tests of the records, and a JSON writer that shares no code with ours."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, Writer

from hjcamp.model.language.field_table import fields_of
from hjcamp.plants.pump_joint import PumpJoint
from hjcamp.records.log import TestLog

FIELD_NAMES = fields_of(PumpJoint).names
METADATA = {"campaign": "bench", "condition": "ramp", "repetition": "1", "started_at": "2026-11-21T05:00:00+00:00"}
ATTACHMENTS = {"config.yaml": b"pump: pump2\n"}


def make_columns(samples: int = 600, before: int = 0, seed: int = 7) -> dict[str, np.ndarray]:
    """Return every field of a test whose command phase starts after ``before`` samples; each ``seed`` has its own noise."""
    time = (np.arange(samples) - before) * 0.001
    noise = np.random.default_rng(seed).normal(0.0, 7e-4, (2, samples))
    return {
        "time_s": time,
        "phase": np.where(time < -1e-9, 2.0, 3.0),
        "reference_deg": 60 * np.sin(time),
        "arm_deg": np.round(60 * np.sin(time - 0.01) * 1024 / 360) * 360 / 1024,
        "pressure1_mpa": 0.3 + 0.1 * np.sin(time) + noise[0],
        "pressure2_mpa": 0.3 - 0.1 * np.sin(time) + noise[1],
        "pump_deg": np.round(500 * np.sin(time) / 0.18) * 0.18,
        "command_deg": 500 * np.sin(time),
        "pid_deg": 5 * np.cos(time),
        "feedforward_deg": np.zeros(samples),
        "dither_v": 1.2 * np.sin(2 * np.pi * 250 * time),
    }


def make_log(samples: int = 600, before: int = 0) -> TestLog:
    """Return a test log with metadata and one attachment."""
    return TestLog(make_columns(samples, before), dict(METADATA), dict(ATTACHMENTS))


def rows(columns: Mapping[str, np.ndarray]) -> list[dict[str, Any]]:
    """Return the samples as one dict each."""
    return [dict(zip(columns, map(float, values), strict=True)) for values in zip(*columns.values(), strict=True)]


def json_file(
    samples: Iterable[Any],
    topics: tuple[str, ...] = ("/test/sample",),
    metadata: Mapping[str, str] | None = None,
    encoding: str = "json",
    **options: Any,
) -> bytes:
    """Return an MCAP file of JSON messages, the same on each topic; raw bytes are written as they are."""
    stream = io.BytesIO()
    writer = Writer(stream, **({"compression": CompressionType.ZSTD, "chunk_size": 16 * 1024} | options))
    writer.start(profile="", library="another logger")
    schema = writer.register_schema("hjcamp.Sample", "jsonschema", json.dumps({"type": "object"}).encode())
    channels = [writer.register_channel(topic, encoding, schema) for topic in topics]
    writer.add_metadata("hjcamp.test", dict(METADATA if metadata is None else metadata))
    for index, sample in enumerate(samples):
        content = sample if isinstance(sample, bytes) else json.dumps(sample).encode()
        time = 1_760_000_000_000_000_000 + index * 1_000_000
        for channel in channels:
            writer.add_message(channel, time, content, time, index)
    writer.finish()
    return stream.getvalue()


def write_json(path: Path, columns: Mapping[str, np.ndarray], **options: Any) -> Path:
    """Write columns as a JSON log."""
    path.write_bytes(json_file(rows(columns), **options))
    return path
