"""What answers in Python say, draw and write for any plant that has no module of its own for it."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report
from hjcamp.analyses.diagnosing import diagnose_plant
from hjcamp.errors import UsageError, unknown

if TYPE_CHECKING:
    from hjcamp.analyses.adding import Added
    from hjcamp.analyses.diagnosing import Asked

OVER_NOISE_FLOOR = "error over noise floor"


def said_of(data: Data) -> Any:
    """Return the module that speaks of these tests: the plant's own, else this one."""
    return data.plant.room_of("python") or importlib.import_module(__name__)


def compared(data: Data, names: Sequence[str], report: Report) -> tuple[Any, dict[str, Any]]:
    """Return models on tests, and the answer for programs."""
    from hjcamp.analyses.comparing import compare_plant
    from hjcamp.diagnosis.results.comparison import answer

    found = compare_plant(data, names, report)
    return found, answer(found)


def comparison_sentences(found: Any) -> list[str]:
    """Return where the error of the last model is, in words."""
    from hjcamp.commands.any_plant.comparison_words import notes_on
    from hjcamp.commands.any_plant.words import noise_floor_note

    return [noise_floor_note(found.analysis), *notes_on(found)]


def comparison_drawn(found: Any) -> tuple[Any, ...]:
    """Return what draws measurement and models where the error is largest, and what it draws."""
    return comparison_moved(found, {})


def comparison_moved(found: Any, values: Mapping[str, float]) -> tuple[Any, ...]:
    """Return the same with a further model: the calibrated one with ``values`` of base parameters (SI), where there are any.

    ``UsageError`` for a name that it has not.
    """
    from hjcamp.commands.any_plant.pages import _stretch
    from hjcamp.report.pictures.prediction import draw_windows

    errors = {one.name: one.errors for one in (*found.models, found.calibrated)}
    if values:
        from hjcamp.diagnosis.results.comparison import predicted_errors

        allowed = comparison_sliders(found)
        for name in values:
            if name not in allowed:
                raise unknown("parameter", name, allowed, "sliders")
        moved = found.analysis.base.fitted.candidate.with_base(values)
        errors["with these values"] = predicted_errors(found.analysis, moved)[1]
    return draw_windows, *_stretch(found.analysis, errors, found.models[-1].errors)


def comparison_sliders(found: Any) -> dict[str, tuple[float, float, float]]:
    """Return for each base parameter the ends and the step of a slider about its calibrated value, SI: half of it to both sides."""
    from hjcamp.diagnosis.residuals.simulated import ZERO

    sliders = {}
    for one in found.analysis.base.fitted.free:
        if not one.effect and not one.name.startswith(ZERO):
            value = one.value_in(found.analysis.base.fitted.candidate)
            half = 0.5 * abs(value) or one.scale
            low, high = max(value - half, one.low), min(value + half, one.high)
            sliders[one.name] = (low, high, (high - low) / 200.0)
    return sliders


def comparison_page(found: Any, folder: Path) -> Path:
    """Write the pictures and the page; return the path of the page."""
    from hjcamp.commands.any_plant.pages import write_comparison

    return write_comparison(found, folder)[-1]


def diagnosed(data: Data, asked: Asked, report: Report) -> tuple[Any, dict[str, Any]]:
    """Return the words of a diagnosis, and the answer for programs."""
    from hjcamp.commands.any_plant.verdict_words import Words

    done = diagnose_plant(data, asked, report)
    return Words(done.analysis, done.verdict, done.content), done.content


def diagnosis_sentences(words: Any) -> list[str]:
    """Return what the verdict means and what it rests on."""
    return list(words.sentences())


def diagnosis_drawn(words: Any) -> tuple[Any, ...]:
    """Return what draws the evidence, and what it draws."""
    from hjcamp.commands.any_plant.evidence import explained_of, missing_of
    from hjcamp.report.pictures.evidence import draw_explained, draw_missing

    if words.shows_a_law:
        missing = replace(missing_of(words), after=())
        return (lambda: draw_missing(missing)["before"],)
    if words.verdict.named:
        return draw_explained, *explained_of(words)
    raise UsageError(f"{words.title}: nothing was fitted, so there is nothing to draw")


def diagnosis_page(words: Any, folder: Path) -> Path:
    """Write the pictures and the page; return the path of the page."""
    from hjcamp.commands.any_plant.pages import write_diagnosis

    return write_diagnosis(words, folder)[-1]


def added(data: Data, names: Sequence[str], name: str, model: str, report: Report) -> Added:
    """Fit effects and save the model."""
    from hjcamp.analyses.adding import add

    return add(data, names, name, model, report)


def calibrated(data: Data, name: str, only: Sequence[str], overwrite: bool, report: Report) -> tuple[Path, dict[str, Any], Any]:
    """Fit the base parameters and save them: the model's file, rows, the analysis."""
    from hjcamp.analyses.calibrating import fit_plant

    fitted = fit_plant(data, name, report)
    return fitted.model, fitted.rows, fitted.analysis
