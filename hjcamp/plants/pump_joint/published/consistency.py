"""Where the print contradicts itself: means, deviations and percentages that its own repetitions exclude."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from hjcamp.plants.pump_joint.published.slips import slips
from hjcamp.plants.pump_joint.published.values import constants, printed_rows

HALF_STEP = 0.05
HALF_STEP_OF_STD = 0.005
ROUNDING_NOISE = 1e-9


@dataclass(frozen=True)
class Inconsistency:
    """One printed number outside the interval that the printed repetitions imply."""

    place: str
    cell: str
    printed: float
    lowest: float
    highest: float


def implied_mean(tests: list[float]) -> tuple[float, float]:
    """Return the interval of the true mean: every repetition is known to within half of 0.1 deg."""
    mean = float(np.mean(tests))
    return mean - HALF_STEP, mean + HALF_STEP


def implied_std(tests: list[float], divisor_less: int = 0) -> tuple[float, float]:
    """Return the smallest and largest standard deviation that the rounded repetitions allow.

    ``divisor_less`` is 0 for the deviation as the thesis forms it (divided by n), 1 for the sample deviation (n - 1).
    The deviation is a convex function of the repetitions: its largest value lies at a corner of the box of half width
    0.05 deg; its smallest is found on the distance of every interval to a common centre.
    """
    values = np.asarray(tests)
    corners = values + HALF_STEP * np.array(list(product((-1.0, 1.0), repeat=len(values))))
    # For a centre c, each repetition can come as near as max(|x - c| - half step, 0); best over a fine grid of centres.
    centres = np.linspace(values.min() - HALF_STEP, values.max() + HALF_STEP, 4001)
    distances = np.maximum(np.abs(values - centres[:, None]) - HALF_STEP, 0.0)
    smallest = np.sqrt(np.min(np.sum(distances**2, axis=1)) / (len(values) - divisor_less))
    return float(smallest), float(np.max(np.std(corners, axis=1, ddof=divisor_less)))


def sample_deviations_excluded() -> int:
    """Return how many printed deviations could not be sample standard deviations (divided by n - 1)."""
    return len(_of_deviations(divisor_less=1))


def print_inconsistencies() -> list[Inconsistency]:
    """Return every printed mean, deviation and percentage that its own repetitions exclude, rounding allowed for.

    Checked: means and deviations of Tables 5.4.1, 5.4.2, 5.5.1 and 5.5.2 against their seven repetitions; Tables 5.5.3
    and 6.3.1 against those means; the improvements that the text of 5.3.3 and 5.5 states.
    """
    return [*_of_means(), *_of_deviations(), *_of_repeated_means(), *_of_statements()]


def _of_means() -> list[Inconsistency]:
    found = []
    for row in printed_rows().iter_rows(named=True):
        low, high = implied_mean(_tests(row))
        found.append((f"Table {row['table']}, mean", _name(row), row["mean_printed"], low - HALF_STEP, high + HALF_STEP))
    return _outside(found)


def _of_deviations(divisor_less: int = 0) -> list[Inconsistency]:
    found = []
    for row in printed_rows().drop_nulls("std_printed").iter_rows(named=True):
        low, high = implied_std(_tests(row), divisor_less)
        low, high = low - HALF_STEP_OF_STD, high + HALF_STEP_OF_STD
        found.append((f"Table {row['table']}, deviation", _name(row), row["std_printed"], low, high))
    return _outside(found)


def _of_repeated_means() -> list[Inconsistency]:
    means = {_name(row): row["mean_printed"] for row in printed_rows().iter_rows(named=True)}
    repeated: list[tuple[str, str, float]] = []
    table = constants()["table_5_5_3"]
    for indicator in ("rmse1", "rmse2", "e_max", "sse"):
        for trajectory, controllers in table[indicator].items():
            for controller, values in controllers.items():
                for column, value in zip(table["columns"], values, strict=True):
                    key = {"trajectory": trajectory, "controller": controller, "indicator": indicator} | column
                    repeated.append(("Table 5.5.3", _name(key), value))
    for indicator, rows in constants()["table_6_3_1"].items():
        for trajectory, columns in rows.items():
            for controller in ("pid", "ffwd_pid"):
                key = {"trajectory": trajectory, "controller": controller, "indicator": indicator}
                key |= {"payload": "none", "orientation": "horizontal"}
                repeated.append(("Table 6.3.1", _name(key), columns[controller]))
    return _outside([(place, cell, value, abs(means[cell]), abs(means[cell])) for place, cell, value in repeated])


def _of_statements() -> list[Inconsistency]:
    tests = {_name(row): _tests(row) for row in printed_rows().iter_rows(named=True)}
    found = []
    for statement in constants()["statements"]:
        before_low, before_high = implied_mean(tests[_name(statement | {"controller": "pid"})])
        after_low, after_high = implied_mean(tests[_name(statement | {"controller": "ffwd_pid"})])
        # The author may have taken the printed means, which are known to 0.05 as well: half a step more on each side.
        low = 100.0 * (1.0 - (after_high + HALF_STEP) / (before_low - HALF_STEP)) - 0.5
        high = 100.0 * (1.0 - (after_low - HALF_STEP) / (before_high + HALF_STEP)) + 0.5
        cell = _name(statement | {"controller": "ffwd_pid against pid"})
        found.append((f"Section {statement['section']}, improvement in percent", cell, statement["percent"], low, high))
    return _outside(found)


def _outside(found: list[tuple[str, str, float, float, float]]) -> list[Inconsistency]:
    return [
        Inconsistency(place, cell, float(printed), low, high)
        for place, cell, printed, low, high in found
        if not low - ROUNDING_NOISE <= printed <= high + ROUNDING_NOISE
    ]


def _tests(row: dict[str, Any]) -> list[float]:
    return [row[f"test{number}"] for number in range(1, 8)]


def _name(row: dict[str, Any]) -> str:
    return " ".join(str(row[name]) for name in ("trajectory", "controller", "payload", "orientation", "indicator"))


TEXT = """# Where the thesis contradicts its own repetitions

Made by `python -m hjcamp.plants.pump_joint.published.consistency > docs/published_inconsistencies.md`.

The seven repetitions of each cell are printed to 0.1 deg, so each is known to within 0.05 deg. That fixes an interval
for their mean (half a step of the printed mean is added) and for their standard deviation (printed to 0.01). A printed
number outside its interval cannot come from the printed repetitions.

Checked: {means} means, {deviations} deviations, Tables 5.5.3 and 6.3.1 (they repeat the means) and {statements}
percentages of the text.

## The printed deviation divides by n

Taken as sample standard deviations (divided by n - 1), {sample} of the {deviations} printed deviations are excluded by
their repetitions; divided by n, {population} are. So `Std. Dev.` in the thesis is the root mean square deviation.
The tables of hjcamp carry the sample standard deviation; for 7 tests it is sqrt(7/6) = 1.08 times larger. The published
deviations next to them stay as printed.

## What remains

| where | cell | printed | possible |
|---|---|---|---|
{rows}

The two percentages of 5.5 look like one slip: the text gives 18 % for the mixed and 35 % for the negative cycloidal
motion, the table gives them the other way round.

Wider statements that the tables do not bear out (read, not computed):

* Abstract: steady state error within 0.2 deg for both controllers. Table 5.4.2 has 0.4 deg (negative cycloid, PID).
* 5.7: the feedforward lowers the tracking error by at least 25 %. RMSE1 of the positive cycloid falls by 23 %.
* 5.7: it lowers the largest error by at least 20 %. The positive ramp gains 16 %, the negative cycloid 9 %, and the
  positive cycloid gets 24 % worse (Table 5.4.1).

## Slips of the text

Each with its arithmetic (`hjcamp/plants/pump_joint/published/slips.py`).

| where | the text says | its numbers give | arithmetic |
|---|---|---|---|
{slips}
"""


def inconsistencies_text() -> str:
    """Return docs/published_inconsistencies.md: the list with the intervals and how it was made."""
    rows = []
    for item in print_inconsistencies():
        digits = 1 if "percent" in item.place else 3
        possible = f"{item.lowest:.{digits}f} to {item.highest:.{digits}f}"
        rows.append(f"| {item.place} | {item.cell} | {item.printed:g} | {possible} |")
    return TEXT.format(
        means=len(printed_rows()),
        deviations=len(printed_rows().drop_nulls("std_printed")),
        statements=len(constants()["statements"]),
        sample=sample_deviations_excluded(),
        population=len(_of_deviations()),
        rows="\n".join(rows),
        slips="\n".join(f"| {one.place} | {one.says} | {one.follows} | {one.arithmetic} |" for one in slips()),
    )


if __name__ == "__main__":
    print(inconsistencies_text(), end="")
