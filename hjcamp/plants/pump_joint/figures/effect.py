"""The picture of what an effect does to a test: arm angle, error and pressures, without it and with it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, GRID, INK, RED, own_settings
from hjcamp.storage import whole_file

Columns = Mapping[str, NDArray[np.float64]]
PANELS = (
    ("arm_deg", "Arm angle (deg)"),
    ("error_deg", "Error (deg)"),
    ("pressure1_mpa", "Pressure 1 (MPa)"),
    ("pressure2_mpa", "Pressure 2 (MPa)"),
)
SIZE = (7.4, 7.2)


def draw_effect(path: Path, title: str, without: Columns, with_effect: Columns) -> None:
    """Write the picture of one test, by log columns without and with the effect; the format follows the suffix."""
    from matplotlib.figure import Figure

    with own_settings({}), whole_file(path) as stream:
        figure = Figure(figsize=SIZE, layout="constrained")
        paint_effect(figure, title, without, with_effect)
        figure.savefig(stream, dpi=150, format=path.suffix[1:].lower())


def paint_effect(figure: Any, title: str, without: Columns, with_effect: Columns) -> None:
    """Fill a figure with that picture."""
    figure.suptitle(title, x=0.01, ha="left", fontsize=10, color=INK)
    axes = figure.subplots(len(PANELS), 1, sharex=True, height_ratios=[1.4, 1.0, 1.0, 1.0])
    for one, (name, label) in zip(axes, PANELS, strict=True):
        if name == "arm_deg":
            seconds, reference = _command_phase(without, "reference_deg")
            one.plot(seconds, reference, color=INK, linewidth=0.9, linestyle=(0, (4, 2.5)), label="reference")
        for columns, colour, legend, width in ((without, BLUE, "without", 2.4), (with_effect, RED, "with", 1.0)):
            one.plot(*_command_phase(columns, name), color=colour, linewidth=width, label=legend)
        _dress(one, label)
    axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, fontsize=8, frameon=False, borderaxespad=0.1)
    axes[-1].set_xlabel("Time (s)", color=INK, fontsize=8.5)


def _command_phase(columns: Columns, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    chosen = columns["phase"] == 3.0
    values = columns["reference_deg"] - columns["arm_deg"] if name == "error_deg" else columns[name]
    return columns["time_s"][chosen], values[chosen]


def _dress(axes: Any, label: str) -> None:
    axes.set_ylabel(label, color=INK, fontsize=8.5)
    axes.grid(True, axis="y", color=GRID, linewidth=0.5)
    axes.margins(x=0.0, y=0.08)
    axes.tick_params(colors=INK, labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
