"""What the tests of any plant say of every fitted parameter: the corner plot and the table beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from hjcamp.commands._plant_words import Words

FITTED = ("parameter", "value", "95 %", "most like", "correlation", "")
#: Of these a test says hardly more than of their sum or ratio.
ALIKE = 0.95
SAID = (
    "In standard errors from the value above each column; lines hold 68 and 95 %. A correlation near 1 or -1: these tests "
    "hardly tell the two apart, and each is known less well than both together."
)


def fitted_parameters(words: Words) -> tuple[str, list[list[str]]]:
    """Return the corner plot (empty for fewer than two) and the rows of every fitted parameter of the model found."""
    from hjcamp.prediction.intervals import covariance_of, intervals
    from hjcamp.report.corner_figure import correlation_of, draw_corner
    from hjcamp.report.units import plain, shown, told, told_interval

    analysis = words.analysis
    fitted, chapters = words.verdict.model.fitted, analysis.search.chapters
    rows: list[dict[str, Any]] = []
    kept, factors = [], []
    for place, (one, free) in enumerate(zip(intervals(fitted, chapters), fitted.free, strict=True)):
        unit = _unit(words, one.effect, one.name)
        if unit is None:
            continue
        value, name = shown(one.value, unit)
        # one step of the free parameter, in the unit that is shown
        factors.append(
            (one.value if free.log else free.scale) * (value / one.value if one.value else shown(1.0, unit)[0])
        )
        kept.append(place)
        label = f"{one.effect} {one.name}".strip().replace("_", " ").replace("delay.", "delay of ")
        rows.append({"label": label, "value": one.value, "shown": value, "unit": unit, "shown_unit": name,
                     "ci95": [one.low, one.high], "at_bound": one.at_bound})  # fmt: skip
    if not rows:
        return "", []
    covariance = covariance_of(fitted, chapters)[np.ix_(kept, kept)] * np.outer(factors, factors)
    correlation = correlation_of(covariance)
    body = []
    for place, row in enumerate(rows):
        others = np.abs(correlation[place])
        others[place] = -1.0
        most = int(np.argmax(others))
        alike = len(rows) > 1
        remark = "at its bound" if row["at_bound"] else "hardly told apart" if alike and others[most] > ALIKE else ""
        body.append([row["label"], told(row["value"], row["unit"]), told_interval(row),
                     rows[most]["label"] if alike else "", f"{correlation[place, most]:+.2f}" if alike else "", remark])  # fmt: skip
    if len(rows) < 2:
        return "", body
    spread = np.sqrt(np.diag(covariance))
    values = [
        f"{plain(row['shown'])} ± {plain(float(one), 1)} {row['shown_unit']}".rstrip()
        for row, one in zip(rows, spread, strict=True)
    ]
    return draw_corner([row["label"] for row in rows], values, correlation), body


def _unit(words: Words, effect: str, name: str) -> str | None:
    """Return the SI unit of a fitted parameter, None for the zeros of sensors and for laws without a name."""
    from hjcamp.model.base_values import DELAY
    from hjcamp.prediction.windows import ZERO

    if effect:
        known = words.analysis.search.library.get(effect)
        return known.parameters[name].unit if known is not None else None
    if name.startswith(ZERO):
        return None
    return "s" if name.startswith(DELAY) else words.analysis.measured.plant.parameters[name].unit
