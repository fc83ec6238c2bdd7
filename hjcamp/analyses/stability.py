"""Whether a calibration depends on how it was made: the same fit with windows of other lengths, and without each test."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hjcamp.analyses.data import Report, silent
from hjcamp.errors import HjcampError

if TYPE_CHECKING:
    from hjcamp.diagnosis.calibration.analysis import Analysis
    from hjcamp.diagnosis.data.tests import Measured

MOST_LEFT_OUT = 8  # single tests are left out up to so many, else conditions
LEVEL = 0.05  # over all parameters and all fits


@dataclass(frozen=True)
class Varied:
    """A calibration that was made otherwise: ``words`` say how; ``values`` by parameter, SI, none where that could not be fitted.

    ``share``: the variance of its difference from the calibration with all, in those of the latter: 1 / (n - 1) without one of n tests.
    """

    words: str
    values: dict[str, float]
    share: float


def varied(analysis: Analysis, report: Report = silent) -> list[Varied]:
    """Return the calibration with windows of half and double length, and of all tests but one, or but one condition."""
    from hjcamp.diagnosis.calibration.analysis import Known, calibrated

    names = list(analysis.measured.plant.base_parameters)
    found, asked = [], list(_asked(analysis))
    for count, (words, measured, width, share) in enumerate(asked):
        report(words, count / len(asked))
        known = Known(dict(analysis.base.fitted.candidate.base), apart=True)
        try:
            base = calibrated(measured, {}, width=width, unknowns=False, known=known).base.fitted.candidate.base
        except HjcampError:
            base = {}
        found.append(Varied(words, {name: base[name] for name in names if name in base}, share))
    return found


def _asked(analysis: Analysis) -> Iterator[tuple[str, Measured, int | None, float]]:
    from hjcamp.diagnosis.data.segments import SHORTEST_OF_ALL

    measured, width = analysis.measured, analysis.windows.layout.width
    longest = min(test.samples for test in measured.tests) // 2
    for other in (width // 2, 2 * width):
        if SHORTEST_OF_ALL <= other <= longest:
            yield f"windows of {other} samples instead of {width}", measured, other, 1.0
    names = [test.log.path.stem if test.log.path else test.condition for test in measured.tests]
    parts = {name: [place] for place, name in enumerate(names)}
    if len(parts) < len(names) or len(names) > MOST_LEFT_OUT:
        parts = measured.conditions
    for name, places in parts.items() if len(parts) > 1 else ():
        rest = [place for place in range(len(names)) if place not in places]
        yield f"without {name}", measured.of(rest), None, len(places) / len(rest)


def stability_rows(rows: dict[str, dict[str, Any]], found: list[Varied]) -> dict[str, dict[str, Any]]:
    """Return for each parameter its value by each way, and by which it differs from that of all tests by more than chance (SI).

    A normal deviate at 5 % over all comparisons (Bonferroni), by the interval of the calibration with all tests.
    """
    from scipy.special import ndtri

    fitted = {name for one in found for name in one.values}
    known = {name: row for name, row in rows.items() if name in fitted and row.get("ci95") and None not in row["ci95"]}
    most = float(ndtri(1.0 - LEVEL / (2.0 * max(len(known) * len(found), 1))))
    usual = float(ndtri(0.975))
    told: dict[str, dict[str, Any]] = {}
    for name, row in known.items():
        half = 0.5 * (row["ci95"][1] - row["ci95"][0])
        values = {one.words: one.values.get(name) for one in found}
        allowed = {one.words: half * most / usual * float(np.sqrt(one.share)) for one in found}
        moved = [words for words, value in values.items() if value is not None and abs(value - row["value"]) > allowed[words]]
        told[name] = {"value": row["value"], "unit": row["unit"], "ci95": row["ci95"], "varied": values, "moved": moved}
    return told


def stability_words(told: dict[str, dict[str, Any]], found: list[Varied]) -> list[str]:
    """Say what depends on the windows' length or on single tests, or that nothing does; and what could not be fitted."""
    said = []
    for name, row in told.items():
        for words in row["moved"]:
            said.append(f"'{name}' is {row['varied'][words]:.4g} {row['unit']} {words}, {row['value']:.4g} with all")
    lost = [one.words for one in found if not one.values]
    said += [f"{words}: it could not be calibrated" for words in lost]
    if not found:
        return ["stability: there is one test, and it is too short for windows of other lengths"]
    return said or ["no parameter depends on the windows' length or on one test by more than chance explains"]
