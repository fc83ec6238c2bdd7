"""The pictures and the page of a comparison."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.commands.shared.page_end import made_from, next_steps
from hjcamp.errors import counted
from hjcamp.plants.pump_joint.answers.error_words import in_unit, over_words, worse_than_mean
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.plants.pump_joint.diagnosis.compare import Compared, Comparison
    from hjcamp.plants.pump_joint.figures.discrepancy import Overlay

#: The caption and the drawing of each model's map, by its name.
Maps = Mapping[str, tuple[str, str]]
NOT_CALIBRATED = "not calibrated on these tests: friction and stiffness of another specimen count here"
FITTED_TO = "the fit looks at short windows, pressures and forces, this number at whole tests; use it as it stands"
HEADINGS = ("model", "channel", "error", "noise floor", "error / noise floor", "r2")


def error_cells(one: Compared, name: str) -> list[str]:
    """Return the cells of one channel of one model: what it is, error, floor, error over noise floor, r2."""
    from hjcamp.report.wording.units import label

    error = one.errors[name]
    if error is None:
        return [label(name), "not logged", "", "", ""]
    noise_floor = "none" if error.noise_floor is None else in_unit(error.noise_floor, name)
    over = "" if error.ratio is None else f"{error.ratio:.1f}"
    return [
        label(name),
        in_unit(error.rms, name),
        noise_floor,
        over,
        "" if error.r2 is None else f"{error.r2:.3f}",
    ]


def calibrated_in_words(found: Comparison) -> list[str]:
    """Return the sentences of the places that the calibrated model leaves, first of all where it is the worse one."""
    from hjcamp.report.wording.repeatability import worse_calibrated

    if not found.calibrated:
        return []
    last = found.models[-1]
    worse = worse_calibrated(last.replay.name, last.score, found.calibrated.score, FITTED_TO)
    return [*worse, *places_in_words(found.calibrated)]


def places_in_words(one: Compared) -> list[str]:
    """Return the sentences of one model's places; without repetitions nothing says how much of the error is left.

    Logs that differ from their repetitions are named in place of them.
    """
    from hjcamp.plants.pump_joint.answers.where_words import where_sentences

    evidence = one.replay.evidence
    said = list(evidence.odd) or where_sentences(one.places, one.score if evidence.repeated else None)
    return [*worse_than_mean(one.errors), *said]


def write_pictures(found: Comparison, folder: Path, following: Sequence[str] = ()) -> list[Path]:
    """Write overlay, where, horizon and the page that holds them, with the commands that go on; return their paths, the page last."""
    from hjcamp.plants.pump_joint.answers.compare_map import maps_of
    from hjcamp.report.pages import discrepancy_page as page

    models, calibrated = found.models, found.calibrated
    shown = [*models, calibrated] if calibrated else models
    maps = maps_of(shown)
    pictures = _pictures(found, shown, maps)
    files = [folder / f"{name}.svg" for name in pictures]
    for file, svg in zip(files, pictures.values(), strict=True):
        with whole_file(file) as stream:
            stream.write(svg.encode())
    path = folder / "index.html"
    with whole_file(path) as stream:
        title = "Comparison: " + ", ".join(one.replay.name for one in models)
        parts = _parts(found, shown, maps, pictures, following)
        stream.write(page.discrepancy_page(title, lead_of(models, calibrated), parts).encode())
    return [*files, path]


def _pictures(found: Comparison, shown: Sequence[Compared], maps: Maps) -> dict[str, str]:
    """Return the pictures of a comparison by the names of their files."""
    from hjcamp.plants.pump_joint.figures.discrepancy import HorizonCurve, draw_horizon, draw_overlay
    from hjcamp.report.pictures.drawing import draw_errors

    last = found.models[-1]
    curves = [HorizonCurve(one.replay.name, one.horizon.time, one.horizon.rms) for one in shown]
    repeated = last.replay.evidence.repeated
    scores = [(one.replay.name, one.score) for one in shown] + ([("noise floor", 1.0)] if repeated else [])
    pictures = {
        "errors": draw_errors(scores, over_words(repeated), repeated),
        "overlay": draw_overlay(worst_overlay(found.models)),
        "where": maps[last.replay.name][1],
        "horizon": draw_horizon(curves, last.horizon.noise_floor),
    }
    if found.calibrated:
        pictures["where_calibrated"] = maps[found.calibrated.replay.name][1]
    return pictures


def _parts(
    found: Comparison, shown: Sequence[Compared], maps: Maps, pictures: Mapping[str, str], following: Sequence[str]
) -> list[str]:
    """Return the parts of the page: each model's error, the worst test, where a model errs, and when."""
    from hjcamp.plants.pump_joint.answers.compare_explorer import exploration_of
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.pages.explorer import explorer_html
    from hjcamp.report.wording.names import readable
    from hjcamp.report.wording.repeatability import NO_NOISE_FLOOR

    models, last, calibrated = found.models, found.models[-1], found.calibrated
    repeated = "The noise floor is what repetitions of one test do not share: no model goes below it. 1.0 is perfect."
    overlay = f"Overlay: {readable(worst_overlay(models).name)}, where {models[0].replay.name} is furthest off"
    parts = [
        page.table_of(HEADINGS, [[one.replay.name, *error_cells(one, name)] for one in shown for name in one.errors]),
        page.note(repeated if last.replay.evidence.repeated else NO_NOISE_FLOOR),
        page.picture("Error of each model", pictures["errors"]),
        next_steps(following),
        explorer_html(exploration_of(found)),
        page.picture(overlay, pictures["overlay"]),
        page.heading(f"Where: {last.replay.name}" + (", as it stands" if calibrated else "")),
        page.note(NOT_CALIBRATED.capitalize() + ".") if calibrated else "",
        *_where(last, places_in_words(last), maps),
    ]
    if calibrated:
        parts += [
            page.heading("Where: after calibrating its base parameters on these tests"),
            *_where(calibrated, calibrated_in_words(found), maps),
        ]
    return [
        *parts,
        page.heading("When: error against horizon"),
        page.picture("Error of the arm against the time since a restart from measured states", pictures["horizon"]),
        made_from(test.log for test in last.replay.evidence.tests),
    ]


def _where(one: Compared, said: Sequence[str], maps: Maps) -> list[str]:
    """Return the words, the table and the map of where a model errs."""
    from hjcamp.plants.pump_joint.answers.compare_map import PALE_SAID
    from hjcamp.report.pages import discrepancy_page as page

    title, svg = maps[one.replay.name]
    return [
        page.bullets(said),
        page.place_table([place.row() for place in one.places]),
        page.picture(title, svg),
        page.note(PALE_SAID),
    ]


def lead_of(models: list[Compared], calibrated: Compared | None = None) -> str:
    """Return the answer in one line."""
    told = " -> ".join(f"{one.score:.2f}" for one in models)
    told += f" ({calibrated.score:.2f} after calibrating its base parameters)" if calibrated else ""
    evidence = models[0].replay.evidence
    tests = (
        f"{counted(len(evidence.tests), 'test')}, {counted(len(evidence.conditions), 'condition')}, driven by the measured pump"
    )
    if not evidence.repeated:
        return f"Error over the spread of the measurement {told}; no test was repeated, so repeatability is unknown. {tests}."
    return f"Error over noise floor, geometric mean of arm and lines: {told}. {tests}."


def worst_overlay(models: list[Compared]) -> Overlay:
    """Return the first test of the condition in which the arm of the first model is furthest off, with all models."""
    import numpy as np

    from hjcamp.plants.pump_joint.figures.discrepancy import Overlay
    from hjcamp.records.log import observed

    first = models[0].replay
    evidence = first.evidence
    parts = {
        name: slice(int(evidence.edges[tests[0]]), int(evidence.edges[tests[0] + 1]))
        for name, tests in evidence.conditions.items()
    }
    errors = {name: np.mean((first.predicted[p, 0] - first.measured[p, 0]) ** 2) for name, p in parts.items()}
    name = max(errors, key=lambda one: float(errors[one]))
    part = parts[name]
    time = evidence.tests[evidence.conditions[name][0]].time
    predicted = {one.replay.name: one.replay.predicted[part] for one in models}
    return Overlay(name, time, first.measured[part], predicted, observed(test.log for test in evidence.tests))
