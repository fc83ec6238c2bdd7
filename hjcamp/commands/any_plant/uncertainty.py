"""Profiles of the likelihood and posterior draws of a calibration: in words, in the answer, on a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.analyses.calibrating import Fitted
    from hjcamp.diagnosis.estimation.profile import Profile

PAGES = Path("calibration")
HEADINGS = ("parameter", "declared", "value", "95 % by likelihood ratio", "95 % by curvature")


@dataclass(frozen=True)
class Further:
    """What is asked for besides intervals by curvature; ``draws``: the file for those of the posterior."""

    profile: bool = False
    stability: bool = False
    draws: Path | None = None


@dataclass(frozen=True)
class Uncertainty:
    """What is said, what goes into the answer, and the files that were written."""

    notes: list[str]
    content: dict[str, Any]
    files: dict[str, Path]


def uncertainty(done: Fitted, name: str, asked: Further, report: Callable[[str, float], None]) -> Uncertainty:
    """Compute what is asked for of a calibration, and write the page ``calibration/NAME.html`` and the file of draws."""
    from hjcamp.analyses.stability import stability_rows, stability_words, varied
    from hjcamp.analyses.uncertainty import profile_row, profiles_of, unit_of, write_posterior
    from hjcamp.diagnosis.estimation.posterior import MIXED

    notes: list[str] = []
    content: dict[str, Any] = {}
    files: dict[str, Path] = {}
    said: list[str] = []
    found = profiles_of(done.analysis, report) if asked.profile else []
    if asked.profile:
        notes += [one.words for one in found if one.words]
        content["profiles"] = [profile_row(one, unit_of(done.analysis, one)) for one in found]
    if asked.stability:
        others = varied(done.analysis, report)
        content["stability"] = stability_rows(done.rows, others)
        said = stability_words(content["stability"], others)
        notes += said
    if asked.profile or asked.stability:
        files["page"] = _page(done, name, found if asked.profile else None, content.get("stability"), said)
        content["page"] = str(files["page"])
    draws = asked.draws
    if draws is not None:
        drawn = write_posterior(done.analysis, draws, report)
        worst = float(drawn.r_hat.max())
        if worst > MIXED:
            notes.append(f"the chains of the posterior do not agree yet: R-hat is {worst:.3f}, at most {MIXED} is wanted")
        content["posterior"] = {"file": str(draws), "r_hat": worst, "accepted": drawn.accepted, "names": list(drawn.names)}
        files["draws"] = draws
    return Uncertainty(notes, content, files)


def _page(done: Fitted, name: str, found: list[Profile] | None, stability: dict[str, Any] | None, said: Sequence[str]) -> Path:
    """Write the page with a picture of each profile and the table of what was made otherwise, and return its path."""
    from hjcamp.report.pages import discrepancy_page as page

    path = PAGES / f"{name}.html"
    leads: list[str] = []
    parts: list[str] = []
    if found is not None:
        lead, drawn = _profiles(done, found)
        leads.append(lead)
        parts += drawn
    if stability is not None:
        leads += [f"{one[:1].upper()}{one[1:]}." for one in said]
        parts += _stability(stability)
    tests = len(done.analysis.measured.tests)
    parts.append(page.note(f"Model {name}, {tests} tests of plant {done.analysis.measured.plant.name}."))
    with whole_file(path) as stream:
        stream.write(page.discrepancy_page(f"Calibration {name}", " ".join(leads), parts).encode())
    return path


def _stability(told: dict[str, Any]) -> list[str]:
    """Return the table of calibrations, a row for each way; * is more than chance explains."""
    from hjcamp.report.pages import discrepancy_page as page

    def cell(row: dict[str, Any], way: str) -> str:
        value = row["varied"][way]
        return "-" if value is None else f"{value:.4g}{' *' if way in row['moved'] else ''}"

    names = [name.replace("_", " ") + ("" if row["unit"] == "1" else f" ({row['unit']})") for name, row in told.items()]
    whole = [f"{row['value']:.4g} ({row['ci95'][0]:.4g} to {row['ci95'][1]:.4g})" for row in told.values()]
    ways = dict.fromkeys(way for row in told.values() for way in row["varied"])
    rows = [["all tests (95 %)", *whole], *([way, *(cell(row, way) for row in told.values())] for way in ways)]
    return [
        page.table_of(("calibrated with", *names), rows),
        page.note(
            "* differs from the value of all tests by more than chance explains, at 5 % over the whole table: another model, "
            "a drift of the rig, or one odd test. What changes with the length of the windows depends on how errors grow."
        ),
    ]


def _profiles(done: Fitted, found: list[Profile]) -> tuple[str, list[str]]:
    """Return what the profiles say in a line, and their pictures with the table of their ends."""
    from hjcamp.analyses.uncertainty import unit_of
    from hjcamp.diagnosis.estimation.profile import limit
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.pictures.profile import draw_profile

    pictures, rows = [], []
    for one in found:
        unit = unit_of(done.analysis, one)
        label = f"{one.name.replace('_', ' ')}{f' ({unit})' if unit != '1' else ''}"
        pictures.append((label, draw_profile(label, one.values, one.rise, one.value, limit())))
        row = done.rows[one.name]
        ends = [end if end is None else f"{end:.4g}" for end in (one.low, one.high)]
        low, high = ends[0] or "not bounded", ends[1] or "not bounded"
        curved = row["ci95"] if row.get("told", True) else None
        by_curvature = f"{curved[0]:.4g} to {curved[1]:.4g}" if curved else "not known"
        between = "not identified" if one.flat else f"{low} to {high}"
        rows.append([label, f"{row['published']:.4g}", f"{one.value:.4g}", between, by_curvature])
    said = [one.words for one in found if one.words]
    lead = " ".join(f"{one[:1].upper()}{one[1:]}." for one in said) or "These tests bound every parameter on both sides."
    parts = [
        page.side_by_side(pictures),
        page.note(
            "Each parameter is held at the values of its dots while all others are fitted again. Below the dashed line is the "
            "95 % interval; a line that stays below it says that the tests do not bound the parameter on that side."
        ),
        page.table_of(HEADINGS, rows),
    ]
    return lead, parts
