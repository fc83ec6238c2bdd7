"""What an identification answers: estimates with intervals, the charts that support them, warnings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hjcamp.report.wording.units import decimals_of, rounded

Array = NDArray[np.float64]
LEVEL = 0.95


@dataclass(frozen=True)
class Estimate:
    """One identified constant in SI units; ``interval`` is None where the repetitions do not give one.

    ``shown_unit`` and ``shown_scale`` are for people: shown = value * shown_scale. ``published`` is the reference
    value (SI) where there is one.
    """

    name: str
    value: float
    unit: str
    interval: tuple[float, float] | None
    tests: int
    text: str
    shown_unit: str
    shown_scale: float = 1.0
    published: float | None = None

    @property
    def shown(self) -> str:
        """Value and interval in the unit for people, with the digits that the interval allows."""
        value, ends = self.texts
        return " ".join(filter(None, (value, f"[{', '.join(ends)}]" if ends else "", self.shown_unit)))

    @property
    def texts(self) -> tuple[str, tuple[str, ...]]:
        """The value and the ends of its interval in the unit for people, rounded equally; no ends where there is no interval."""
        value = self.value * self.shown_scale
        if self.interval is None:
            return f"{value:.4g}", ()
        ends = [end * self.shown_scale for end in self.interval]
        places = decimals_of(0.5 * (ends[1] - ends[0]), value)
        said = [f"{one:.6g}" if places is None else rounded(one, places) for one in (value, *ends)]
        return said[0], tuple(said[1:])


@dataclass(frozen=True)
class Series:
    """One curve of a chart; ``style`` is line, dashed, points or faint."""

    x: Array
    y: Array
    label: str
    style: str = "line"
    colour: int = 0


@dataclass(frozen=True)
class Chart:
    """What a person needs to see to believe an estimate; ``figure`` is the figure of the thesis that it repeats."""

    name: str
    figure: str
    caption: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    logarithmic: bool = False
    logarithmic_x: bool = False


@dataclass(frozen=True)
class Finding:
    """The answer of one identification: estimates, charts, warnings, and facts for people (name to text)."""

    subject: str
    estimates: tuple[Estimate, ...] = ()
    charts: tuple[Chart, ...] = ()
    warnings: tuple[str, ...] = ()
    facts: dict[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Estimate:
        return next(one for one in self.estimates if one.name == name)


def mean_interval(values: Sequence[float] | Array, resolution: float = 0.0) -> tuple[float, tuple[float, float] | None]:
    """Return mean and 95 % interval of repeated results; None where there is one result only.

    .. math:: \\bar x \\pm \\sqrt{(t_{n-1} s / \\sqrt n)^2 + (1.96\\, u / \\sqrt n)^2}

    with u the standard uncertainty that the sensor's ``resolution`` leaves to one result, which repetitions that fall
    on the same count do not show. Source: JCGM 100:2008 (GUM), 4.2, 4.3.7 and G.4.
    """
    from scipy.stats import t

    numbers = np.asarray(values, dtype=np.float64)
    mean = float(numbers.mean())
    if len(numbers) < 2:
        return mean, None
    spread = float(t.ppf(0.5 + LEVEL / 2, len(numbers) - 1) * numbers.std(ddof=1))
    half = math.hypot(spread, 1.96 * resolution / math.sqrt(12.0)) / math.sqrt(len(numbers))
    return mean, (mean - half, mean + half)
