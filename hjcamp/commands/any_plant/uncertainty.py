"""Profiles of the likelihood and posterior draws of a calibration: in words, in the answer, on a page."""

from __future__ import annotations

from collections.abc import Callable
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
class Uncertainty:
    """What is said, what goes into the answer, and the files that were written."""

    notes: list[str]
    content: dict[str, Any]
    files: dict[str, Path]


def uncertainty(
    done: Fitted, name: str, profile: bool, draws: Path | None, report: Callable[[str, float], None]
) -> Uncertainty:
    """Compute what is asked for of a calibration, and write the page ``calibration/NAME.html`` and the file of ``draws``."""
    from hjcamp.analyses.uncertainty import profile_row, profiles_of, unit_of, write_posterior
    from hjcamp.diagnosis.estimation.posterior import MIXED

    notes: list[str] = []
    content: dict[str, Any] = {}
    files: dict[str, Path] = {}
    if profile:
        found = profiles_of(done.analysis, report)
        notes += [one.words for one in found if one.words]
        content["profiles"] = [profile_row(one, unit_of(done.analysis, one)) for one in found]
        files["page"] = _page(done, name, found)
        content["page"] = str(files["page"])
    if draws is not None:
        drawn = write_posterior(done.analysis, draws, report)
        worst = float(drawn.r_hat.max())
        if worst > MIXED:
            notes.append(f"the chains of the posterior do not agree yet: R-hat is {worst:.3f}, at most {MIXED} is wanted")
        content["posterior"] = {"file": str(draws), "r_hat": worst, "accepted": drawn.accepted, "names": list(drawn.names)}
        files["draws"] = draws
    return Uncertainty(notes, content, files)


def _page(done: Fitted, name: str, found: list[Profile]) -> Path:
    """Write the page with a picture of each profile, and return its path."""
    from hjcamp.analyses.uncertainty import unit_of
    from hjcamp.diagnosis.estimation.profile import limit
    from hjcamp.report.pages import discrepancy_page as page
    from hjcamp.report.pictures.profile import draw_profile

    path = PAGES / f"{name}.html"
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
    tests = len(done.analysis.measured.tests)
    lead = " ".join(f"{one[:1].upper()}{one[1:]}." for one in said) or "These tests bound every parameter on both sides."
    parts = [
        page.side_by_side(pictures),
        page.note(
            "Each parameter is held at the values of its dots while all others are fitted again. Below the dashed line is the "
            "95 % interval; a line that stays below it says that the tests do not bound the parameter on that side."
        ),
        page.table_of(HEADINGS, rows),
        page.note(f"Model {name}, {tests} tests of plant {done.analysis.measured.plant.name}."),
    ]
    with whole_file(path) as stream:
        stream.write(page.discrepancy_page(f"Calibration {name}", lead, parts).encode())
    return path
