"""Pictures of a controller's design: the same motion step by step in one view, and one error under several filters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.pictures.conditions import BLUE, INK, RED, tidy
from hjcamp.report.pictures.drawing import draw, dress

Array = NDArray[np.float64]
DASHED = (0, (4, 2.5))


@dataclass(frozen=True)
class DesignStep:
    """One test of a design: ``title`` says what it has, columns (n,) in the units of their names."""

    title: str
    time: Array
    reference_deg: Array
    arm_deg: Array
    pressure1_mpa: Array
    pressure2_mpa: Array
    pid_deg: Array


def draw_steps(steps: Sequence[DesignStep]) -> str:
    """Return the SVG of all steps side by side on common axes: angle, error, pressures, feedback part of the command."""

    def paint(figure: Any) -> None:
        axes = figure.subplots(4, len(steps), sharex=True, sharey="row", squeeze=False, height_ratios=[1.5, 1, 1, 1])
        for column, one in enumerate(steps):
            angle, error, pressure, command = axes[:, column]
            angle.plot(one.time, one.reference_deg, color=INK, linewidth=0.9, linestyle=DASHED, label="reference")
            angle.plot(one.time, one.arm_deg, color=BLUE, linewidth=1.1, label="arm")
            error.plot(one.time, one.reference_deg - one.arm_deg, color=BLUE, linewidth=0.9)
            pressure.plot(one.time, one.pressure1_mpa, color=BLUE, linewidth=0.9, label="line 1")
            pressure.plot(one.time, one.pressure2_mpa, color=RED, linewidth=0.9, label="line 2")
            command.plot(one.time, one.pid_deg, color=BLUE, linewidth=0.9)
            angle.set_title(one.title, fontsize=8.5, loc="left")
            labels = ("Angle (deg)", "Error (deg)", "Pressure (MPa)", "Command (deg)")
            for axis, label in zip(axes[:, column], labels, strict=True):
                dress(axis, label if column == 0 else "")
            command.set_xlabel("Time (s)", fontsize=8.5)
        for row in (0, 2):
            axes[row, 0].legend(fontsize=7.5, frameon=False)

    return tidy(draw((2.1 * len(steps) + 1.2, 7.0), "design steps", paint))


def draw_filters(time: Array, signals: Sequence[tuple[str, Array]]) -> str:
    """Return the SVG of control signals over time, one below the other with equal axes; ``signals`` are title and deg."""

    def paint(figure: Any) -> None:
        axes = figure.subplots(len(signals), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (title, values) in zip(axes, signals, strict=True):
            axis.plot(time, values, color=BLUE, linewidth=0.9)
            axis.set_title(title, fontsize=8.5, loc="left")
            dress(axis, "Command (deg)")
        axes[-1].set_xlabel("Time (s)", fontsize=8.5)

    return tidy(draw((6.6, 1.7 * len(signals) + 0.5), "derivative filters", paint))
