"""Tests with what models say of them as topics of an MCAP file, and layouts by which viewers show them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType, Writer
from numpy.typing import NDArray

from hjcamp.errors import HjcampError
from hjcamp.model.language.field_unit import unit_of_field
from hjcamp.records.views.viewer_layouts import Panels, write_layouts
from hjcamp.records.write import start_time_ns
from hjcamp.storage import file_names, whole_file

Array = NDArray[np.float64]
Channels = Mapping[str, Array]
MEASURED = "/test/measured"


@dataclass(frozen=True)
class ModelledTest:
    """One test: ``time`` (n,) in s, what was measured and what each model says, each channel (n,) in its field's unit."""

    name: str
    condition: str
    time: Array
    measured: Channels
    models: Mapping[str, Channels]
    metadata: Mapping[str, str]


def topic_of(kind: str, model: str) -> str:
    """Return the topic of a model's predictions or residuals: names hold letters, digits and _ alone, for every viewer."""
    return f"/{kind}/{re.sub(r'[^A-Za-z0-9_]+', '_', model).strip('_') or 'model'}"


def write_modelled(folder: Path, tests: Iterable[ModelledTest]) -> list[Path]:
    """Write NAME.mcap for each test and a layout for Foxglove and PlotJuggler; return the paths, the layouts last.

    Messages are JSON with a JSON schema, which says each channel's unit. Residuals are measured less predicted. A value that
    is not finite is left out of its message. Raises ``HjcampError`` where there is no test.
    """
    written: list[Path] = []
    names: dict[str, list[str]] = {}
    tests = list(tests)
    for test, stem in zip(tests, file_names(test.name for test in tests), strict=True):
        path = folder / f"{stem}.mcap"
        topics = topics_of(test)
        _write(path, test, topics)
        written.append(path)
        for topic, channels in topics.items():
            names.setdefault(topic, [])
            names[topic] += [one for one in channels if one not in names[topic]]
    if not written:
        raise HjcampError(f"{folder}: there is no test to write")
    return written + write_layouts(folder, _panels(names), "models")


def topics_of(test: ModelledTest) -> dict[str, Channels]:
    """Return the channels of each topic: measured, each model's predictions, each model's residuals."""
    found: dict[str, Channels] = {MEASURED: test.measured}
    for model, channels in test.models.items():
        found[topic_of("model", model)] = channels
        found[topic_of("residual", model)] = {
            name: test.measured[name] - values for name, values in channels.items() if name in test.measured
        }
    return found


def _write(path: Path, test: ModelledTest, topics: Mapping[str, Channels]) -> None:
    start = start_time_ns(test.metadata)
    times = start + np.rint((test.time - test.time[0]) * 1e9).astype(np.int64)
    with whole_file(path) as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start(profile="", library="hjcamp")
        writer.add_metadata("hjcamp.test", {key: str(test.metadata[key]) for key in sorted(test.metadata)})
        channels = []
        for topic, columns in topics.items():
            schema = writer.register_schema(topic.strip("/").replace("/", "."), "jsonschema", _schema(columns))
            units = {f"unit.{name}": unit_of_field(name, topic).shown for name in columns}
            channels.append((writer.register_channel(topic, "json", schema, units), columns))
        for row, when in enumerate(times.tolist()):
            for channel, columns in channels:
                values = {name: float(one[row]) for name, one in columns.items() if np.isfinite(one[row])}
                writer.add_message(channel, when, json.dumps(values).encode(), when, row)
        writer.finish()


def _schema(columns: Channels) -> bytes:
    properties = {name: {"type": "number", "description": unit_of_field(name, "").shown} for name in columns}
    return json.dumps({"type": "object", "properties": properties}).encode()


def _panels(names: Mapping[str, Sequence[str]]) -> Panels:
    """Return what each panel shows: a channel of all topics together, its residuals below."""
    modelled = [name for topic, known in names.items() if topic != MEASURED for name in known]
    panels: Panels = {}
    for channel in dict.fromkeys(modelled):
        having = [topic for topic, known in names.items() if channel in known]
        for title, residual in ((channel, False), (f"residual of {channel}", True)):
            panels[title] = [
                (topic, channel, topic.strip("/")) for topic in having if topic.startswith("/residual/") == residual
            ]
    return panels
