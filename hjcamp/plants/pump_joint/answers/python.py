"""What answers in Python say, draw and write for tests of the joint."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.analyses.data import Data, Report
from hjcamp.plants.pump_joint.answers.error_words import OVER_NOISE_FLOOR as OVER_NOISE_FLOOR

if TYPE_CHECKING:
    from hjcamp.analyses.adding import Added
    from hjcamp.analyses.diagnosing import Asked


def compared(data: Data, names: Sequence[str], report: Report) -> tuple[Any, dict[str, Any]]:
    """Return models on tests, and the answer for programs."""
    from hjcamp.plants.pump_joint.analyses.comparing import compare_joint
    from hjcamp.plants.pump_joint.analyses.evidence import evidence_in
    from hjcamp.plants.pump_joint.diagnosis.compare import answer

    found = compare_joint(data, names, report)
    return found, answer(found.models, len(evidence_in(data).tests))


def comparison_sentences(found: Any) -> list[str]:
    """Return where the error of the last model is, in words."""
    from hjcamp.plants.pump_joint.answers.compare_page import places_in_words

    return places_in_words(found.models[-1])


def comparison_drawn(found: Any) -> tuple[Any, ...]:
    """Return what draws measurement and models where the error is largest, and what it draws."""
    from hjcamp.plants.pump_joint.answers.compare_page import worst_overlay
    from hjcamp.plants.pump_joint.figures.discrepancy import draw_overlay

    return draw_overlay, worst_overlay(found.models)


def comparison_page(found: Any, folder: Path) -> Path:
    """Write the pictures and the page; return the path of the page."""
    from hjcamp.plants.pump_joint.answers.compare_page import write_pictures

    return write_pictures(found, folder)[-1]


def diagnosed(data: Data, asked: Asked, report: Report) -> tuple[Any, dict[str, Any]]:
    """Return the words of a diagnosis, and the answer for programs."""
    from hjcamp.plants.pump_joint.analyses.diagnosing import diagnose_joint
    from hjcamp.plants.pump_joint.answers.diagnose_words import Told
    from hjcamp.plants.pump_joint.answers.evidence import gathered

    told = Told(**vars(diagnose_joint(data, asked, report, gather=gathered)))
    return told, told.content


def diagnosis_sentences(words: Any) -> list[str]:
    """Return what the verdict means and what it rests on."""
    return list(words.answer())


def diagnosis_drawn(words: Any) -> tuple[Any, ...]:
    """Return what draws the errors before and after, and what it draws."""
    from hjcamp.report.pictures.drawing import draw_errors

    scale = words.judging.scale
    return draw_errors, *words.bars()


def diagnosis_page(words: Any, folder: Path) -> Path:
    """Write the pictures and the page; return the path of the page."""
    from hjcamp.plants.pump_joint.answers.diagnose_page import write_pictures

    return write_pictures(words, folder)[-1]


def added(data: Data, names: Sequence[str], name: str, model: str, report: Report) -> Added:
    """Fit effects and save the model."""
    from hjcamp.plants.pump_joint.analyses.adding import add

    return add(data, names, name, model, report)


def calibrated(data: Data, name: str, only: Sequence[str], overwrite: bool, report: Report) -> tuple[Path, dict[str, Any], Any]:
    """Identify the constants and save them: the model's file, rows, what was found."""
    from hjcamp.plants.pump_joint.analyses.calibrating import identify_joint, pairs

    done = identify_joint(data, name, pairs(only), replace=overwrite)
    rows = {
        key: {"published": one.published, "value": one.value, "unit": one.unit, "ci95": one.interval}
        for key, one in done.found.estimates.items()
    }
    return done.model, rows, done.found
