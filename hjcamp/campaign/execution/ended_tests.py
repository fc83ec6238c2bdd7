"""What is said of tests that ended: the error of what they followed, one line for each condition, news for the live page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hjcamp.known_plants import plant_of
from hjcamp.live.feed import current_feed

if TYPE_CHECKING:
    from rich.console import Console

    from hjcamp.campaign.execution.outcome import Outcome
    from hjcamp.campaign.files.run_folder import RunFolder
    from hjcamp.records.plan import PlannedTest

COMMAND_PHASE = 3.0


def followed_error(columns: Mapping[str, NDArray[np.float64]], config: Mapping[str, Any]) -> tuple[str, float] | None:
    """Return what the plant controls and its RMS error over the command phase, in the field's unit; None without a reference."""
    from hjcamp.controllers.fit import controlled_field
    from hjcamp.report.pages.exploration import references

    followed = controlled_field(plant_of(config))
    known = {name: values for name, values in columns.items() if name == followed or name.startswith("reference_")}
    reference = references(known).get(followed)
    if reference is None:
        return None
    moving = columns["phase"] == COMMAND_PHASE if "phase" in columns else columns["time_s"] >= -1e-9
    left = (reference - columns[followed])[moving]
    return (followed, float(np.sqrt(np.mean(left**2)))) if left.size else None


class Ends:
    """Hears of each test that ends; prints a line, in a file too, when the last test of a condition did."""

    def __init__(self, folder: RunFolder, waiting: Sequence[PlannedTest], console: Console, compiling: str = "") -> None:
        plan = folder.plan
        self._folder, self._console, self._feed = folder, console, current_feed()
        self._left: dict[str, int] = {}
        for test in waiting:
            self._left[test.condition] = self._left.get(test.condition, 0) + 1
        self._ended: dict[str, list[Outcome]] = {name: [] for name in self._left}
        self._open = len(self._left)
        self._logs = {test.id: folder.path / test.log for test in plan.tests}
        if self._feed is not None:
            tests = {one.name: plan.repetitions for one in plan.conditions}
            kept = {name: number - self._left.get(name, 0) for name, number in tests.items()}
            self._feed.run(plan.campaign, folder.path, {one.name: one.config for one in plan.conditions}, tests, kept)
            if compiling:
                self._feed.compiling(compiling)

    def __call__(self, outcome: Outcome) -> None:
        """Take in how one test ended."""
        name = outcome.condition
        done = outcome.state == "done"
        if self._feed is not None:
            log: Path | None = self._logs[outcome.test] if done else None
            self._feed.ended(outcome.test, name, log, outcome.error, "" if done else f"{outcome.test}: {outcome.message}")
        self._ended[name].append(outcome)
        self._left[name] -= 1
        if not self._left[name]:
            self._open -= 1
            line = condition_line(name, self._ended[name])
            self._console.print(f"  {line}   {self._open} to go", markup=False)
            self._folder.note(line)
            self._ended[name] = []


def condition_line(name: str, ended: Sequence[Outcome]) -> str:
    """Return what became of a condition: tests, failures, RMS error with its standard deviation, seconds of work."""
    from hjcamp.report.wording.channels import described

    errors = [one.error for one in ended if one.state == "done" and one.error is not None]
    failed = sum(one.state != "done" for one in ended)
    words = [f"{len(ended)} test{'s' * (len(ended) != 1)}"] + ([f"{failed} failed"] if failed else [])
    if errors:
        told = described(errors[0][0], name)
        values = [value for _, value in errors]
        spread = f" ± {np.std(values, ddof=1):.2g}" if len(values) > 1 else ""
        words.append(f"RMS error of {told['label']} {np.mean(values):.4g}{spread} {told['unit']}".rstrip())
    words.append(f"{sum(one.seconds for one in ended):.1f} s")
    return f"{name.replace('__', ' / ')}   {', '.join(words)}"
