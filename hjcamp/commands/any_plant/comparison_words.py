"""The tables and notes of compare for any plant."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hjcamp.commands.any_plant.head_words import print_head
from hjcamp.commands.any_plant.plant_hints import far_states
from hjcamp.commands.any_plant.remarks.bound_words import held_by_bounds
from hjcamp.diagnosis.levels import DELTA
from hjcamp.report.wording.units import told

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.diagnosis.results.comparison import Comparison
from hjcamp.commands.any_plant.words import DIVERGES, NORMALISED, SLOW, WHOLE, end_words, noise_floor_note, table


def print_comparison(console: Console, found: Comparison) -> None:
    """Print the errors of the models."""
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.diagnosis.results.calibration_rows import calibration

    print_head(console, found.analysis)
    table(console, *comparison_table(found))
    print_wrapped(console, [noise_floor_note(found.analysis)], 8)
    print_wrapped(console, notes_on(found), 8)
    worse = [one.name for one in (*found.models, found.calibrated) if any(one.explained < 0.0)]
    if worse:
        of = "test" if found.analysis.windows.layout.memory else "window"
        print_wrapped(console, [f"{', '.join(worse)}: worse than the mean of each {of} in a channel (explained below 0)."], 8)
    print_wrapped(console, held_by_bounds(calibration(found.analysis)), 8)
    if rows := whole_table(found):
        console.print(f"whole tests   {WHOLE}", markup=False)
        table(console, *rows)
        print_wrapped(console, [SLOW], 8)


def notes_on(found: Comparison) -> list[str]:
    """Return in words where sensors end, and where the last model is the worse for being calibrated."""
    from hjcamp.diagnosis.results.channel_rows import end_rows

    windows = found.analysis.windows
    return [*end_words(end_rows(windows.layout)), *further_off(found), *far_states(windows)]


def further_off(found: Comparison) -> list[str]:
    """Return in words where the last model is the worse for being calibrated, and where one errs less in a channel than a nearer."""
    from hjcamp.report.wording.repeatability import worse_calibrated

    last, here = found.models[-1], found.calibrated
    why = "the fit gives less weight to what scatters more, this number weights all equally; use it as it stands"
    said = worse_calibrated(last.name, last.score, here.score, why)
    others = [(here, "what is calibrated here"), *((one, one.name) for one in found.models)]
    better = [
        f"{one.name} errs less in {sensor.quantity.replace('_', ' ')} than {label}, though its normalised error is "
        "larger: that weights "
        "all shapes of the error in all channels equally, each by its noise; an rms is mostly its largest shape, of "
        "which a fit gives up "
        "some for the others where something is missing."
        for other, label in others
        for k, sensor in enumerate(found.analysis.measured.sensors)
        for one in found.models
        if one.rms[k] < (1.0 - DELTA) * other.rms[k] and one.score > other.score
    ]
    return said + better[:1]


def _share(explained: float) -> str:
    """Return a share in percent; of a model that diverges no number is worth reading."""
    return f"{100.0 * explained:.2f} %" if explained > -100.0 else "far below 0"


def _error(value: float, unit: str) -> str:
    """Return an error, or that there is none."""
    return told(value, unit) if math.isfinite(value) else "diverges"


def comparison_table(found: Comparison) -> tuple[tuple[str, ...], list[list[str]]]:
    """Return the head and rows of a comparison: model, each channel's rms with the share explained, over the noise floor."""
    from hjcamp.report.wording.channels import channel_label

    layout = found.analysis.windows.layout
    sensors = layout.measured.sensors
    head = (
        "model",
        *(channel_label(one.field) for one in sensors),
        *(f"{channel_label(one.field)} explained" for one in sensors),
        NORMALISED,
    )
    rows = [
        [
            one.name,
            *(_error(one.rms[k] * s.scale, s.unit) for k, s in enumerate(sensors)),
            *(_share(one.explained[k]) for k in range(len(sensors))),
            f"{one.score:.2f}" if math.isfinite(one.score) else "",
        ]
        for one in (*found.models, found.calibrated)
    ]
    noise_floor = found.analysis.noise_floor.of_sensors(layout)
    rows.append(
        [
            "noise floor",
            *(told(noise_floor[k] * s.scale, s.unit) for k, s in enumerate(sensors)),
            *("" for _ in sensors),
            "1.00",
        ]
    )
    return head, rows


def whole_table(found: Comparison) -> tuple[tuple[str, ...], list[list[str]]] | None:
    """Return the head and rows of a comparison over whole tests, which of them diverge; nothing where none is looked at so."""
    from hjcamp.report.wording.channels import channel_label

    sensors = found.analysis.measured.sensors
    labels = [channel_label(one.field) for one in sensors]
    models = (*found.models, found.calibrated)
    rows = [
        [
            one.name,
            *(told(one.whole.rms[k] * s.scale, s.unit) for k, s in enumerate(sensors)),
            *map(_share, one.whole.explained),
        ]
        if one.whole
        else [one.name, DIVERGES, *[""] * (2 * len(sensors) - 1)]
        for one in models
    ]
    return (("model", *labels, *(f"{label} explained" for label in labels)), rows) if any(one.whole for one in models) else None
