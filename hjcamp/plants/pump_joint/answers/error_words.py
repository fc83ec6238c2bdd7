"""The errors of models in a table: each channel in its own unit, then how many times the noise floor that is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.plants.pump_joint.diagnosis.residuals.replay import ChannelError
    from hjcamp.plants.pump_joint.diagnosis.scale import Judged, Scale

CHANNELS = {
    "arm_deg": (1.0, "deg"),
    "pressure1_mpa": (1.0, "MPa"),
    "pressure2_mpa": (1.0, "MPa"),
    "pump_deg": (1.0, "deg"),
    "first_reading": (1.0, "deg"),
}
FIRST, LEAST_DEG = "first_reading", 1e-6
MEAN = "arm and lines"
OVER_NOISE_FLOOR = "error / noise floor, geometric mean of arm and lines"
OVER_SPREAD = "error / spread of the measurement, geometric mean of arm and lines"


def in_unit(value: float, channel: str) -> str:
    """Return a value of a channel as people read it."""
    from hjcamp.report.wording.units import plain

    scale, unit = CHANNELS[channel]
    return f"{plain(value * scale)} {unit}"


def over(scale: Scale) -> str:
    """Return what the score of this scale is over."""
    return over_words(scale.repeated)


def over_words(repeated: bool) -> str:
    """Return what scores are over: the floor, or the spread of what was measured where nothing was repeated."""
    return OVER_NOISE_FLOOR if repeated else OVER_SPREAD


def error_table(models: Sequence[tuple[str, Judged]], scale: Scale) -> tuple[list[str], list[list[str]]]:
    """Return headings and rows: channels, then the score; a column for each model that did not run away, and the floor."""
    from hjcamp.report.wording.units import label

    shown = [(name, one) for name, one in models if math.isfinite(one.score)]
    rows = []
    for channel, noise_floor in scale.noise_floors.items():
        cells = [_cell(one.errors[channel], channel) for _, one in shown]
        # a first reading that no model misses says nothing
        said = channel != FIRST or any(error and not _is_nothing(error) for error in (one.errors[channel] for _, one in shown))
        if any(cells) and said:
            rows.append([label(channel), *cells, "none" if noise_floor is None else in_unit(noise_floor, channel)])
    times = " x" if scale.repeated else ""
    rows.append([MEAN, *(f"{one.score:.2f}{times}" for _, one in shown), f"1.00{times}" if scale.repeated else ""])
    return ["error", *(name for name, _ in shown), "noise floor"], rows


def _is_nothing(error: ChannelError) -> bool:
    return error.rms < LEAST_DEG or (error.ratio is not None and error.ratio < 0.05)


def _cell(error: ChannelError | None, channel: str) -> str:
    if error is None:
        return ""
    return in_unit(error.rms, channel) + ("" if error.ratio is None else f"  {error.ratio:.1f} x")


def print_errors(console: Console, models: Sequence[tuple[str, Judged]], scale: Scale) -> None:
    """Print the table of errors."""
    from rich.table import Table
    from rich.text import Text

    headings, rows = error_table(models, scale)
    table = Table(box=None, pad_edge=False, header_style="dim")
    for number, heading in enumerate(headings):
        table.add_column(Text(f"  {heading}" if number == 0 else heading), justify="right" if number else "left")
    for row in rows:
        table.add_row(*(Text(f"  {cell}" if number == 0 else cell) for number, cell in enumerate(row)))
    console.print(table)


def worse_than_mean(errors: Mapping[str, ChannelError | None]) -> list[str]:
    """Return in words which channels a model predicts worse than their own mean would: its r2 is below 0."""
    from hjcamp.report.wording.units import label

    told = [f"{label(name)} ({one.r2:.2g})" for name, one in errors.items() if one and one.r2 is not None and one.r2 < 0]
    if not told:
        return []
    return [f"r2 is negative for {', '.join(told)}: the mean of the measurement would be nearer than the model."]
