"""What diagnose, compare, add and calibrate say first for any plant: the tests, their windows, and what is left out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hjcamp.diagnosis.data.tests import FEWEST_SAMPLES
from hjcamp.report.wording.units import plain

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.diagnosis.calibration.analysis import Analysis


def print_head(console: Console, analysis: Analysis) -> None:
    """Print what the tests are, and the windows that they are cut into."""
    layout, measured = analysis.windows.layout, analysis.measured
    count = f"{len(measured.tests)} test{'s' if len(measured.tests) > 1 else ''}, {len(measured.conditions)} condition"
    console.print(
        f"plant {measured.plant.name}: {count}{'s' if len(measured.conditions) > 1 else ''}, "
        f"{len(layout.of_test)} windows of {plain(layout.width * measured.period)} s"
        + (f" of {sum(layout.whole)}, in runs that are evenly spread" if len(layout.of_test) < sum(layout.whole) else "")
        + (
            f", each test simulated through from its own start: the plant remembers {plain(layout.memory * measured.period, 2)} s"
            if layout.memory
            else ", each begun from its own start" + _carried(analysis)
        ),
        markup=False,
    )
    for again, first in measured.twice:
        console.print(f"note    {again} is a copy of {first}: both count once", markup=False)
    for line in measured.odd:
        console.print(f"note    {line}", markup=False)
    for path, samples in measured.short:
        console.print(f"note    {path} is left out: {samples} samples; at least {FEWEST_SAMPLES} are needed", markup=False)
    for path, field in measured.missing:
        console.print(f"note    {path} is left out: it lacks '{field}', which counts in the others", markup=False)


def over_windows(analysis: Analysis) -> str:
    """Return in words over what an error is taken."""
    layout = analysis.windows.layout
    through = ", tests simulated through" if layout.memory else ""
    return f"over windows of {plain(layout.width * layout.measured.period)} s (their smooth part){through}"


def _carried(analysis: Analysis) -> str:
    """Return in words which states begin a window where the one before left them."""
    layout, unseen = analysis.windows.layout, analysis.windows.unseen
    names = [name for name, hidden in zip(layout.measured.plant.states, unseen, strict=True) if hidden]
    return f"; {', '.join(names)}, which nothing measures, as the window before ended" if names and layout.goes_on.any() else ""
