"""The pages of compare and diagnose for any plant."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.commands.shared.page_end import made_from, next_steps
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.analyses.plant_comparison import PlantComparison
    from hjcamp.commands.any_plant.verdict_words import Words
    from hjcamp.diagnosis.calibration.analysis import Analysis

WINDOWS = 3
EVIDENCE = {
    "missing_before": "What the calibrated model misses over what drives it, and the named law through it",
    "missing_after": "The same with what was found added",
    "beside": "What is missing in addition to what was found",
    "swing": "What the calibrated model errs by over a whole test, the sine in it, and the residual without that",
    "worst_test": "The worst test before and after",
    "gains": "The gains of surrogate data, and the real one",
}
CORRELATIONS = {"correlation_1": "Residual autocorrelation", "correlation_2": "Residual and input: cross-correlation"}
BAND = (
    "Residual autocorrelation, and cross-correlation with what was given before. "
    "White residuals leave the band in one value of twenty."
)
REPEATED = (
    " Dashed: the part that repetitions do not share, which no model can take. A curve that follows it shows the scatter of the rig, "
    "not a missing law; one that leaves it shows what repetitions share."
)


def write_diagnosis(words: Words, folder: Path, following: Sequence[str] = ()) -> list[Path]:
    """Write the pictures and the page of a diagnosis, with the commands that go on; return their paths, the page last."""
    from hjcamp.commands.any_plant import words as said
    from hjcamp.commands.any_plant.corner import fitted_parameters
    from hjcamp.commands.any_plant.evidence import evidence_pictures
    from hjcamp.commands.any_plant.verdict_words import CANDIDATES
    from hjcamp.commands.shared.corner import how_well_known
    from hjcamp.commands.shared.effect_links import equations_of, links, write_effect_pages
    from hjcamp.records.log import observed
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.pictures.prediction import draw_windows

    analysis, verdict = words.analysis, words.verdict
    library = analysis.search.library
    pictures = evidence_pictures(words)
    shown = {"calibrated": analysis.base.fitted.candidate}
    if verdict.effects:
        shown["with what was found"] = verdict.model.fitted.candidate
    pictures["windows"] = draw_windows(
        *_worst(analysis, shown), observed=observed(test.log for test in analysis.measured.tests)
    )
    sentences = words.sentences()
    parts = [
        page.side_by_side([(said, pictures[name]) for name, said in EVIDENCE.items() if name in pictures]),
        page.bullets(sentences[1:]),
        next_steps(following),
        equations_of(verdict.effects, library),
    ]
    if rows := words.candidates():
        parts += [page.heading("Effects, best first"), page.table_of(CANDIDATES, rows), *map(page.note, words.added_note)]
        parts.append(
            page.note(
                "t: of the paired differences over held-out blocks. Residual: the share of their error above repeatability that "
                "remains, of all of it where it lies no higher."
            )
        )
    whole = words.content["whole_tests"]
    parts += [page.heading("Error"), page.table_of(said.CHANNELS, said.channel_table(words.content["channels"], whole))]
    parts.append(page.note(said.noise_floor_note(analysis) + (f" {said.WHOLE_NOTE}" if whole else "")))
    parts.append(page.picture("The worst windows", pictures["windows"]))
    parts += [
        page.heading("Structure of the residuals"),
        page.side_by_side([(said, pictures[name]) for name, said in CORRELATIONS.items() if name in pictures]),
        page.note(BAND + (REPEATED if analysis.measured.repeated else "")),
    ]
    parts += _places(words)
    fitted_with = words.fitted_with
    parts += [
        page.heading("Calibrated first"),
        page.table_of(said.calibrated(fitted_with), said.calibration_table(words.content["calibration"], fitted_with)),
    ]
    known, drawn = how_well_known(*fitted_parameters(words))
    pictures |= drawn
    parts += [*known, links(folder), made_from(test.log for test in analysis.measured.tests)]
    write_effect_pages(folder, [row["effect"] for row in words.content["candidates"]], library)
    return _written(folder, pictures, page.discrepancy_page(words.title, "".join(sentences[:1]), parts))


def _places(words: Words) -> list[str]:
    """Return where the calibrated model fails, and the conditions that err most with what was found."""
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.wording.repeatability import worst_table

    where, worst = words.where(), words.content["worst"]
    found = [page.heading("Where the calibrated model fails"), page.bullets(where)] if where else []
    return found + ([page.heading("Worst conditions"), page.table_of(*worst_table(worst))] if worst else [])


def write_comparison(found: PlantComparison, folder: Path, following: Sequence[str] = ()) -> list[Path]:
    """Write the pictures and the page of a comparison, with the commands that go on; return their paths, the page last."""
    from hjcamp.commands.any_plant import words as said
    from hjcamp.commands.any_plant.comparison_words import comparison_table, notes_on, whole_table
    from hjcamp.commands.any_plant.explorer import exploration_of
    from hjcamp.commands.any_plant.head_words import over_windows
    from hjcamp.records.log import observed
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.pages.exploration import names_of
    from hjcamp.report.pages.explorer import explorer_html
    from hjcamp.report.pictures.prediction import draw_model_bars, draw_windows
    from hjcamp.report.wording.channels import channel_label
    from hjcamp.report.wording.names import readable
    from hjcamp.report.wording.units import plain, told

    analysis = found.analysis
    layout = analysis.windows.layout
    noise_floor = analysis.noise_floor.of_sensors(layout)
    everything = (*found.models, found.calibrated)
    pictures, captions = {}, {}
    for k, one in enumerate(layout.measured.sensors):
        captions[f"error_{one.field}"] = f"Error in {channel_label(one.field)}"
        bars = [(model.name, float(model.rms[k] * one.scale)) for model in everything]
        pictures[f"error_{one.field}"] = draw_model_bars(
            channel_label(one.field), one.unit, bars, float(noise_floor[k] * one.scale)
        )
    errors = {model.name: model.errors for model in everything}
    pictures["windows"] = draw_windows(
        *_stretch(analysis, errors, errors[found.calibrated.name]),
        observed=observed(test.log for test in layout.measured.tests),
    )
    (head, rows), whole, last = comparison_table(found), whole_table(found), found.models[-1]
    of_whole = [page.heading("Whole tests"), page.table_of(*whole), page.note(said.WHOLE_NOTE)] if whole else []
    again = "with each test" if layout.memory else f"again every {plain(layout.width * layout.measured.period)} s"
    parts = [
        page.table_of(head, rows),
        page.note(f"Error {over_windows(analysis)}. {said.noise_floor_note(analysis)}"),
        page.bullets(notes_on(found)),
        next_steps(following),
        *of_whole,
        explorer_html(exploration_of(found)),
        page.note(f"Predictions begin {again}, where each fits best; the table has errors without what those starts do."),
        *(page.picture(caption, pictures[name]) for name, caption in captions.items()),
        page.picture("The worst windows", pictures["windows"]),
        page.heading("Tests"),
        page.table_of(
            ("test", *(f"{channel_label(one.field)} ({last.name})" for one in layout.measured.sensors)),
            [
                [
                    readable(name),
                    *(told(last.by_test[place, k] * s.scale, s.unit) for k, s in enumerate(layout.measured.sensors)),
                ]
                for place, name in enumerate(names_of([test.log for test in layout.measured.tests]))
            ],
        ),
        made_from(test.log for test in layout.measured.tests),
    ]
    return _written(folder, pictures, page.discrepancy_page(f"Models of plant {layout.measured.plant.name}", "", parts))


def _written(folder: Path, pictures: dict[str, str], html: str) -> list[Path]:
    files = [folder / f"{name}.svg" for name in pictures]
    for file, svg in zip(files, pictures.values(), strict=True):
        with whole_file(file) as stream:
            stream.write(svg.encode())
    path = folder / "index.html"
    with whole_file(path) as stream:
        stream.write(html.encode())
    return [*files, path]


def _worst(analysis: Analysis, models: dict[str, Any]) -> tuple[Any, ...]:
    """Return the arguments of the picture of the windows that the first model predicts worst."""
    from hjcamp.diagnosis.results.comparison import predicted_errors

    errors = {name: predicted_errors(analysis, candidate)[1] for name, candidate in models.items()}
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
