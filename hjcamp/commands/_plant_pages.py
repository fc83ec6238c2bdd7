"""The pages of compare and diagnose for any plant."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from hjcamp.commands._plant_words import Words
    from hjcamp.prediction.analysis import Analysis
    from hjcamp.prediction.comparison import Comparison

WINDOWS = 3


def write_diagnosis(words: Words, folder: Path) -> list[Path]:
    """Write the pictures and the page of a diagnosis; return their paths, the page last."""
    from hjcamp.commands import _plant_words as said
    from hjcamp.report import discrepancy_page as page
    from hjcamp.report.prediction_figures import draw_chance, draw_curves, draw_windows

    analysis, verdict = words.analysis, words.verdict
    pictures: dict[str, str] = {}
    if curves := _curves(words):
        pictures["missing"] = draw_curves(curves)
    if analysis.search.steps:
        first = analysis.search.steps[0]
        pictures["chance"] = draw_chance(first.chance, first.gain)
    shown = {"calibrated": analysis.base.fitted.candidate}
    if verdict.effects:
        shown["with what was found"] = verdict.model.fitted.candidate
    pictures["windows"] = draw_windows(*_worst(analysis, shown))
    parts = [page.bullets(words.sentences())]
    if "missing" in pictures:
        parts += [
            page.picture("What is missing, over what drives it (a free law and its 95 % band)", pictures["missing"])
        ]
    if rows := words.candidates():
        parts += [page.heading("Effects, best first"), page.table_of(said.CANDIDATES, rows)]
        parts.append(
            page.note(
                "t: of the paired differences over chapters left out. Left: the error of left-out chapters that stays."
            )
        )
    parts += [page.heading("Error"), page.table_of(said.CHANNELS, said.channel_table(words.content["channels"]))]
    parts.append(page.note(f"{said.FLOORS[analysis.floor.source]}."))
    parts.append(page.picture("The worst windows", pictures["windows"]))
    if "chance" in pictures:
        parts += [
            page.heading("Chance"),
            page.picture("The best gain of the library beside chance", pictures["chance"]),
        ]
    if worst := words.content["worst"]:
        rows = [[one["condition"], one["channel"], f"{one['over_floor']:.2f}"] for one in worst]
        parts += [page.heading("Worst conditions"), page.table_of(("condition", "channel", "over the floor"), rows)]
    parts += [
        page.heading("Calibrated first"),
        page.table_of(said.CALIBRATED, said.calibration_table(words.content["calibration"])),
    ]
    return _written(folder, pictures, page.discrepancy_page(words.title, "", parts))


def write_comparison(found: Comparison, folder: Path) -> list[Path]:
    """Write the pictures and the page of a comparison; return their paths, the page last."""
    from hjcamp.commands import _plant_words as said
    from hjcamp.report import discrepancy_page as page
    from hjcamp.report.prediction_figures import draw_model_bars, draw_windows

    analysis = found.analysis
    layout = analysis.windows.layout
    floor = analysis.floor.of_sensors(layout)
    everything = (*found.models, found.calibrated)
    pictures = {}
    for k, one in enumerate(layout.measured.sensors):
        bars = [(model.name, float(model.rms[k] * one.scale)) for model in everything]
        pictures[f"error_{one.field}"] = draw_model_bars(
            one.quantity.replace("_", " "), one.unit, bars, float(floor[k] * one.scale)
        )
    errors = {model.name: model.errors for model in everything}
    pictures["windows"] = draw_windows(*_stretch(analysis, errors, errors[found.calibrated.name]))
    head, rows = said.comparison_table(found)
    parts = [
        page.table_of(head, rows),
        page.note(f"Error over windows of {layout.width * layout.measured.period:.3g} s. {said.FLOORS[analysis.floor.source]}."),
        *(page.picture(f"Error in {name.removeprefix('error_')}", svg) for name, svg in pictures.items() if name != "windows"),
        page.picture("The worst windows", pictures["windows"]),
        page.heading("Tests"),
        page.table_of(
            ("test", *(f"{one.field} ({found.models[-1].name})" for one in layout.measured.sensors)),
            [
                [test.name, *(f"{found.models[-1].by_test[place, k] * s.scale:.4g}" for k, s in enumerate(layout.measured.sensors))]
                for place, test in enumerate(layout.measured.tests)
            ],
        ),
    ]  # fmt: skip
    return _written(folder, pictures, page.discrepancy_page(f"Models of plant {layout.measured.plant.name}", "", parts))


def _written(folder: Path, pictures: dict[str, str], html: str) -> list[Path]:
    from hjcamp.storage import whole_file

    files = [folder / f"{name}.svg" for name in pictures]
    for file, svg in zip(files, pictures.values(), strict=True):
        with whole_file(file) as stream:
            stream.write(svg.encode())
    path = folder / "index.html"
    with whole_file(path) as stream:
        stream.write(html.encode())
    return [*files, path]


def _curves(words: Words) -> list[tuple[str, str, str, dict[str, Any]]]:
    """Return the freest law before anything was added, and what is still missing after it where something is."""
    from hjcamp.prediction.answer import curve_of

    search = words.analysis.search
    found = []
    if search.steps and search.steps[0].unknown:
        found.append(("before", search.steps[0].unknown[0]))
    after = words.verdict.unknown or (
        search.steps[-1].unknown[0] if len(search.steps) > 1 and search.steps[-1].unknown else None
    )
    if after is not None and words.verdict.effects:
        found.append((f"with {', '.join(words.verdict.model.names)}", after))
    curves = []
    for title, model in found:
        [name] = [one for one in model.names if one in search.unknowns]
        known = search.unknowns[name]
        curve = curve_of(words.analysis, model, name)
        curves.append((title, known.driver, f"{known.quantity} at {known.place}".replace("_", " "), curve))
    return curves


def _worst(analysis: Analysis, models: dict[str, Any]) -> tuple[Any, ...]:
    """Return the arguments of the picture of the windows that the first model predicts worst."""
    errors = {name: analysis.windows.errors(candidate) for name, candidate in models.items()}
    return _stretch(analysis, errors, next(iter(errors.values())))


def _stretch(analysis: Analysis, errors: dict[str, Any], judged: Any) -> tuple[Any, ...]:
    layout = analysis.windows.layout
    measured = layout.measured
    features = (judged / measured.noise).reshape(len(layout.of_test), layout.width, -1)
    squares = np.nan_to_num(np.mean(features**2, axis=1))
    window, k = np.unravel_index(int(np.argmax(squares)), squares.shape)
    mates = np.flatnonzero(layout.of_test == layout.of_test[window])
    first = int(np.clip(window - WINDOWS // 2, mates[0], max(mates[-1] - WINDOWS + 1, mates[0])))
    last = min(first + WINDOWS, int(mates[-1]) + 1)
    rows = slice(first * layout.width, last * layout.width)
    sensor = measured.sensors[k]
    shown = [(name, (layout.readings[rows, k] - one[rows, k]) * sensor.scale) for name, one in errors.items()]
    edges = np.arange(1, last - first) * layout.width
    name = sensor.quantity.replace("_", " ")
    return name, sensor.unit, layout.time[rows], layout.readings[rows, k] * sensor.scale, shown, edges
