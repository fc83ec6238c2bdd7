"""The page of a hunt: it grows with each round."""

from __future__ import annotations

from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.commands.hunting.said import REASONS, STATES, not_ruled_out, said_verdict
from hjcamp.errors import counted
from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.commands.hunting.record import Hunt, Round

COLUMNS = ("round", "tests", "rig time", "error before", "error after", "verdict")


def write_page(folder: Path, hunt: Hunt) -> Path:
    """Write ``index.html`` of a hunt, whole or not at all; return its path."""
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.pictures.hunt import draw_rounds

    last = hunt.last or {}
    spent = f"{hunt.spent_s / 60.0:.3g} of {hunt.budget_s / 60.0:.3g} minutes of the rig, {len(hunt.rounds)} rounds."
    stands = REASONS.get(hunt.reason, "") if hunt.state == "ended" else STATES[hunt.state]
    message = f" {hunt.message}" if hunt.message and hunt.reason != "verdict" else ""
    parts = [page.note(f"{stands}{message} {spent}")]
    judged = [(time, one.diagnosis) for time, one in zip(_spent(hunt.rounds), hunt.rounds, strict=True) if one.diagnosis]
    if judged:
        parts.append(page.picture("Error over the time of the rig", draw_rounds([(t / 60.0, d["error"]) for t, d in judged])))
    parts += [page.heading("What is not ruled out"), page.bullets([_remaining(k, one) for k, one in enumerate(hunt.rounds)])]
    parts += [page.heading("Rounds"), page.table_of(COLUMNS, [_row(k, one) for k, one in enumerate(hunt.rounds)])]
    parts.append(
        page.note(
            "Error: over the noise floor, on data that were not used for the fit; before: calibrated, after: with what was found."
        )
    )
    parts += _drift(page, hunt)
    parts += [page.heading("Tests"), page.bullets([_tests(k, one) for k, one in enumerate(hunt.rounds)])]
    title = f"{hunt.campaign}: {said_verdict(last)}"
    path = folder / "index.html"
    with whole_file(path) as stream:
        stream.write(page.discrepancy_page(title, "", parts).encode())
    return path


def _spent(rounds: list[Round]) -> list[float]:
    return list(accumulate(one.seconds if one.made else 0.0 for one in rounds))


def _row(number: int, one: Round) -> list[str]:
    found = one.diagnosis or {}
    error = found.get("error", {})
    shown = [f"{value:.3g}" if (value := error.get(key)) is not None else "-" for key in ("baseline", "augmented")]
    time = f"{one.seconds:.3g} s" if one.made else "planned"
    return [str(number), str(len(one.tests) * one.repetitions), time, *shown, said_verdict(found)]


def _remaining(number: int, one: Round) -> str:
    return f"After round {number}: {not_ruled_out(one.diagnosis)}" if one.diagnosis else f"Round {number} is not diagnosed yet."


def _tests(number: int, one: Round) -> str:
    return f"Round {number}, {counted(one.repetitions, 'repetition')} each: {'; '.join(row['text'] for row in one.tests)}"


def _drift(page: Any, hunt: Hunt) -> list[str]:
    """Return what is said of a rig that has changed: in which fields, and its base parameters before and after."""
    lines = []
    for number, one in enumerate(hunt.rounds):
        if not one.drift:
            continue
        fields = ", ".join(
            f"{row['field']} by {row['differs']:.3g} (repetitions: {row['repetitions_differ']:.3g})" for row in one.drift
        )
        lines.append(f"Round {number}: a test of the campaign, made again, differs in {fields}. Earlier tests no longer count.")
        before, now = (each.diagnosis or {} for each in (hunt.rounds[number - 1], one))
        for name, row in now.get("base", {}).items():
            if name in before.get("base", {}):
                lines.append(f"{name}: {before['base'][name]['value']:.4g} -> {row['value']:.4g} {row['unit']}")
    return [page.heading("The rig has changed"), page.bullets(lines)] if lines else []
