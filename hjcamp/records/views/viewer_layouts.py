"""Layouts by which Foxglove and PlotJuggler show the topics of MCAP files."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

from hjcamp.storage import whole_file

FOXGLOVE, PLOTJUGGLER = "foxglove_layout.json", "plotjuggler_layout.xml"
COLOURS = ("#1b1f24", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00")
#: What each panel shows, by its title: (topic, channel, label) of each curve.
Panels = dict[str, list[tuple[str, str, str]]]


def write_layouts(folder: Path, panels: Panels, tab: str, states: Mapping[str, str] | None = None) -> list[Path]:
    """Write a layout for Foxglove and one for PlotJuggler into a folder; return their paths.

    ``states`` are values that jump, such as phases, by their title: Foxglove shows them as a band of states.
    """
    written = []
    for name, content in (
        (FOXGLOVE, foxglove_layout(panels, states or {})),
        (PLOTJUGGLER, plotjuggler_layout(panels, tab)),
    ):
        with whole_file(folder / name) as stream:
            stream.write(content.encode())
        written.append(folder / name)
    return written


def foxglove_layout(panels: Panels, states: Mapping[str, str]) -> str:
    """Return a layout of Foxglove: a plot for each panel, one below the other, and a band of states above them."""
    configurations: dict[str, Any] = {}
    for title, path in states.items():
        shown = [{"value": path, "label": title, "enabled": True, "timestampMethod": "receiveTime"}]
        configurations["StateTransitions!0"] = {"paths": shown, "isSynced": True, "foxglovePanelTitle": title}
    for title, curves in panels.items():
        paths = [
            {"value": f"{topic}.{channel}", "enabled": True, "timestampMethod": "receiveTime", "label": label,
             "color": COLOURS[place % len(COLOURS)]}
            for place, (topic, channel, label) in enumerate(curves)
        ]  # fmt: skip
        configurations[f"Plot!{len(configurations)}"] = {
            "paths": paths, "showLegend": True, "isSynced": True, "xAxisVal": "timestamp",
            "showXAxisLabels": True, "showYAxisLabels": True, "legendDisplay": "floating", "foxglovePanelTitle": title,
        }  # fmt: skip
    content = {
        "configById": configurations,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _stacked(list(configurations)),
    }
    return json.dumps(content, indent=2) + "\n"


def _stacked(panels: Sequence[str]) -> Any:
    if len(panels) < 2:
        return panels[0] if panels else ""
    half = len(panels) // 2
    return {
        "direction": "column",
        "first": _stacked(panels[:half]),
        "second": _stacked(panels[half:]),
        "splitPercentage": round(100.0 * half / len(panels), 1),
    }


def plotjuggler_layout(panels: Panels, tab: str) -> str:
    """Return a layout of PlotJuggler: one tab, a plot for each panel, one below the other."""
    areas = []
    for title, shown in panels.items():
        curves = "".join(
            f"<curve name={quoteattr(f'{topic}/{channel}')} color={quoteattr(COLOURS[place % len(COLOURS)])}/>"
            for place, (topic, channel, _) in enumerate(shown)
        )
        areas.append(
            f'<DockArea name={quoteattr(title)}><plot mode="TimeSeries" style="Lines"><limitY/>{curves}</plot></DockArea>'
        )
    sizes = ";".join([f"{1.0 / max(len(panels), 1):.4f}"] * len(panels))
    return (
        "<?xml version='1.0' encoding='UTF-8'?>\n"
        f'<root><tabbed_widget name="Main Window" parent="main_window"><Tab tab_name={quoteattr(tab)} containers="1"><Container>'
        f'<DockSplitter orientation="-" count="{len(panels)}" sizes="{sizes}">{"".join(areas)}</DockSplitter>'
        '</Container></Tab><currentTabIndex index="0"/></tabbed_widget></root>\n'
    )
