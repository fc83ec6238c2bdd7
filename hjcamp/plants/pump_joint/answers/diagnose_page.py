"""The pictures and the page of a diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.commands.shared.page_end import made_from, next_steps
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.answers.diagnose_words import Told

EVIDENCE = {
    "missing_before": "What the calibrated model misses over what drives it, and the named law through it",
    "missing_after": "The same with what was found added",
    "worst_test": "The worst test before and after",
    "gains": "The gains of simulations with nothing missing, and the real one",
}
DETECTABLE = ("effect", "parameter", "smallest that would have been seen")


def write_pictures(told: Told, folder: Path, following: Sequence[str] = ()) -> list[Path]:
    """Write the evidence, the errors, what is unexplained, and the page that holds them, with the commands that go on.

    Returns their paths, the page last.
    """
    from hjcamp.commands.shared.corner import how_well_known
    from hjcamp.commands.shared.effect_links import write_effect_pages
    from hjcamp.plants.pump_joint.answers.corner import fitted_parameters
    from hjcamp.plants.pump_joint.answers.evidence import evidence_pictures
    from hjcamp.plants.pump_joint.figures.unexplained import draw_unexplained
    from hjcamp.report.pictures.drawing import draw_errors

    pictures = evidence_pictures(told.found, told.shown)
    pictures["errors"] = draw_errors(*told.bars())
    if (curve := told.unexplained) is not None:
        horizontal = f"{curve.driver.replace('_', ' ').capitalize()} ({curve.driver_unit})".replace(" ()", "")
        vertical = f"Unexplained {curve.quantity} ({curve.unit})"
        pictures["unexplained"] = draw_unexplained(horizontal, vertical, curve.centres, curve.forward, curve.backward)
    known, drawn = how_well_known(*fitted_parameters(told.judging.best))
    pictures |= drawn
    files = [folder / f"{name}.svg" for name in pictures]
    for file, svg in zip(files, pictures.values(), strict=True):
        with whole_file(file) as stream:
            stream.write(svg.encode())
    write_effect_pages(folder, [row["effect"] for row in told.content["candidates"]], told.library)
    path = folder / "index.html"
    with whole_file(path) as stream:
        stream.write(_page(told, pictures, known, folder, following).encode())
    return [*files, path]


def _page(told: Told, pictures: dict[str, str], known: list[str], folder: Path, following: Sequence[str]) -> str:
    from hjcamp.commands.any_plant.pages import BAND, CORRELATIONS, REPEATED
    from hjcamp.commands.shared.effect_links import equations_of, links
    from hjcamp.plants.pump_joint.answers.diagnose_words import CALIBRATED, CANDIDATES, LEFT
    from hjcamp.plants.pump_joint.answers.error_words import error_table, over
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.wording.repeatability import NO_NOISE_FLOOR, worst_table
    from hjcamp.report.wording.units import label
    from hjcamp.report.wording.units import told as told_value

    answer = told.answer()
    scale = told.judging.scale
    scores = " -> ".join(f"{value:.2f} ({name})" for name, value in told.scores())
    lead = f"{answer[0]} {over(scale).capitalize()}: {scores}." if scores else answer[0]
    parts = [
        page.side_by_side([(said, pictures[name]) for name, said in EVIDENCE.items() if name in pictures]),
        page.bullets([*answer[1:], *told.further_off()]),
        next_steps(following),
        equations_of(told.content["effects"], told.library),
        page.picture("Error before and after", pictures["errors"]),
        page.table_of(*error_table(told.errors(), scale)),
        page.note("On tests that were not used for the fit." + ("" if scale.repeated else f" {NO_NOISE_FLOOR}")),
    ]
    if told.unexplained is not None:
        parts += [page.heading("What no effect explains"), page.picture(answer[1], pictures["unexplained"])]
    if worst := told.content["worst"]:
        parts += [page.heading("Worst conditions"), page.table_of(*worst_table(worst))]
    parts += [page.heading("Where"), page.bullets(told.where()), page.place_table(told.content["where"])]
    if rows := told.candidates():
        parts += [page.heading("Effects, best first"), page.table_of(CANDIDATES, rows)]
        parts.append(page.note(LEFT))
    parts += [
        page.heading("Structure of the residuals"),
        page.side_by_side([(said, pictures[name]) for name, said in CORRELATIONS.items() if name in pictures]),
        page.note(
            "Of the channel in which what was found helps most (the arm where nothing was), over windows that begin at measured "
            f"states. {BAND}{REPEATED if scale.repeated else ''}"
        ),
    ]
    if told.content["minimum_detectable"]:
        least = [
            [name, label(row["parameter"]), told_value(row["value"], row["unit"], 2)]
            for name, row in told.content["minimum_detectable"].items()
        ]
        parts += [page.heading("What these tests would have shown"), page.table_of(DETECTABLE, least)]
    hidden, pairs = told.confounded()
    if hidden or pairs:
        rows = [[name, "hidden by the base parameters", ""] for name in hidden]
        rows += [[names, "similar response", f"{cosine:.2f}"] for names, cosine in pairs]
        parts += [page.heading("Effects that these tests cannot distinguish or cannot detect")]
        parts += [page.table_of(("effects", "why", "cosine"), rows)]
        parts += [page.note("Cosine: between the responses that the base parameters cannot take up; 1 is the same.")]
    parts += [page.heading("Calibrated first"), page.table_of(CALIBRATED, told.calibration(every=True))]
    parts += [*known, links(folder), made_from(test.log for test in told.found.features.evidence.tests)]
    return page.discrepancy_page(told.title, lead, parts)
