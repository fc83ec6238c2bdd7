"""Tests with what models say of them as topics of an MCAP file, and layouts by which viewers show them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from hjcamp.errors import HjcampError
from hjcamp.model.field_unit import unit_of_field
from hjcamp.records.write import start_time_ns
from hjcamp.storage import whole_file

Array = NDArray[np.float64]
Channels = Mapping[str, Array]
MEASURED = "/test/measured"
FOXGLOVE, PLOTJUGGLER = "foxglove_layout.json", "plotjuggler_layout.xml"
COLOURS = ("#1b1f24", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00")


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
    for test in tests:
        stem = re.sub(r"[^\w.-]+", "__", test.name).strip("_") or f"test_{len(written)}"
        path = folder / f"{stem}.mcap"
        topics = topics_of(test)
        _write(path, test, topics)
        written.append(path)
        for topic, channels in topics.items():
            names.setdefault(topic, [])
            names[topic] += [one for one in channels if one not in names[topic]]
    if not written:
        raise HjcampError(f"{folder}: there is no test to write")
    for name, content in ((FOXGLOVE, foxglove_layout(names)), (PLOTJUGGLER, plotjuggler_layout(names))):
        with whole_file(folder / name) as stream:
            stream.write(content.encode())
        written.append(folder / name)
    return written


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
    from mcap.writer import CompressionType, Writer

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


def _panels(names: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
    """Return what each panel shows: a channel of all topics together, its residuals below."""
    modelled = [name for topic, known in names.items() if topic != MEASURED for name in known]
    panels: dict[str, list[str]] = {}
    for channel in dict.fromkeys(modelled):
        having = [topic for topic, known in names.items() if channel in known]
        panels[channel] = [topic for topic in having if not topic.startswith("/residual/")]
        panels[f"residual of {channel}"] = [topic for topic in having if topic.startswith("/residual/")]
    return panels


def foxglove_layout(names: Mapping[str, Sequence[str]]) -> str:
    """Return a layout of Foxglove: a plot for each modelled channel and for its residuals, one below the other."""
    configurations: dict[str, Any] = {}
    for title, topics in _panels(names).items():
        channel = title.removeprefix("residual of ")
        paths = [
            {"value": f"{topic}.{channel}", "enabled": True, "timestampMethod": "receiveTime", "label": topic.strip("/"),
             "color": COLOURS[place % len(COLOURS)]}
            for place, topic in enumerate(topics)
        ]  # fmt: skip
        configurations[f"Plot!{len(configurations)}"] = {
            "paths": paths, "title": title, "showLegend": True, "isSynced": True, "xAxisVal": "timestamp",
            "showXAxisLabels": True, "showYAxisLabels": True, "legendDisplay": "floating", "foxglovePanelTitle": title,
        }  # fmt: skip
    content = {
        "configById": configurations, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1},
        "layout": _stacked(list(configurations)),
    }  # fmt: skip
    return json.dumps(content, indent=2) + "\n"


def _stacked(panels: Sequence[str]) -> Any:
    if len(panels) < 2:
        return panels[0] if panels else ""
    half = len(panels) // 2
    share = round(100.0 * half / len(panels), 1)
    return {
        "direction": "column",
        "first": _stacked(panels[:half]),
        "second": _stacked(panels[half:]),
        "splitPercentage": share,
    }


def plotjuggler_layout(names: Mapping[str, Sequence[str]]) -> str:
    """Return a layout of PlotJuggler: a tab with a plot for each modelled channel and for its residuals."""
    areas = []
    panels = _panels(names)
    for title, topics in panels.items():
        channel = title.removeprefix("residual of ")
        curves = "".join(
            f"<curve name={quoteattr(f'{topic}/{channel}')} color={quoteattr(COLOURS[place % len(COLOURS)])}/>"
            for place, topic in enumerate(topics)
        )
        areas.append(
            f'<DockArea name={quoteattr(title)}><plot mode="TimeSeries" style="Lines"><limitY/>{curves}</plot></DockArea>'
        )
    sizes = ";".join([f"{1.0 / max(len(panels), 1):.4f}"] * len(panels))
    return (
        "<?xml version='1.0' encoding='UTF-8'?>\n"
        '<root><tabbed_widget name="Main Window" parent="main_window"><Tab tab_name="models" containers="1"><Container>'
        f'<DockSplitter orientation="-" count="{len(panels)}" sizes="{sizes}">{"".join(areas)}</DockSplitter>'
        '</Container></Tab><currentTabIndex index="0"/></tabbed_widget></root>\n'
    )
