"""Numbers with their uncertainties as siunitx reads them, and as macros."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from hjcamp.report.tables.formats import escape_latex
from hjcamp.report.wording.units import decimals_of, shown

#: Half a 95 % interval in standard uncertainties of a normal distribution.
COVERAGE = 1.959964


class Quantity(NamedTuple):
    """A value, its standard uncertainty (None: not known) and its unit in siunitx's words."""

    value: float
    uncertainty: float | None
    unit: str
    digits: int = 4  # where no uncertainty is known

    @property
    def latex(self) -> str:
        r"""The quantity as a macro of siunitx, which versions 2 and 3 know."""
        number = uncertain(self.value, self.uncertainty, self.digits)
        return rf"\SI{{{number}}}{{{self.unit}}}" if self.unit else rf"\num{{{number}}}"


def uncertain(value: float, uncertainty: float | None, digits: int = 4) -> str:
    """Return ``1.234(56)``: the uncertainty with two digits, the value with as many places; ``digits`` where none is known."""
    if not uncertainty or not math.isfinite(uncertainty):
        return f"{value:.{digits}g}"
    if not -4 <= math.floor(math.log10(max(abs(value), uncertainty))) < 6:
        power = math.floor(math.log10(max(abs(value), uncertainty)))
        return f"{uncertain(value / 10.0**power, uncertainty / 10.0**power)}e{power}"
    places = max(decimals_of(uncertainty) or 0, 0)
    return f"{value:.{places}f}({round(uncertainty * 10**places)})"


def of_mean(mean: float, std: float | None, n: int, unit: str) -> Quantity:
    r"""Return a mean with its standard uncertainty, s / sqrt(n)."""
    return Quantity(mean, None if std is None else std / math.sqrt(n), unit)


def of_estimate(row: Mapping[str, Any]) -> Quantity:
    """Return a fitted parameter (value, unit, ci95) in the unit that people read."""
    value, unit = shown(row["value"], row["unit"])
    if "deg" in unit:  # siunitx takes literal units or its own macros, not both
        value, unit = row["value"], row["unit"]
    scale = value / row["value"] if row["value"] else 1.0
    ends = row.get("ci95") if None not in (row.get("ci95") or ()) else None
    wide = None if not ends else abs(ends[1] - ends[0]) / (2.0 * COVERAGE) * abs(scale)
    return Quantity(value, wide, unit_latex(unit))


def unit_latex(unit: str) -> str:
    """Return a unit as siunitx reads it literally: ``kPa s/mm3`` is ``kPa.s/mm^3``."""
    plain = "" if unit == "1" else unit
    text = plain.replace("*", ".").replace(" ", ".")
    for base in ("mm", "s", "m"):
        for power in ("2", "3"):
            text = text.replace(f"{base}{power}", f"{base}^{power}")
    # TeX reads ^^5c as a backslash: a power alone stays as it is
    parts = re.split(r"((?<!\^)\^-?\d)", text)
    return "".join(part if place % 2 else escape_latex(part) for place, part in enumerate(parts))


def macros(quantities: Mapping[str, Quantity]) -> str:
    """Return the file of macros, a line for each quantity."""
    lines = ["% needs \\usepackage{siunitx}; in brackets: the standard uncertainty, of a mean s / sqrt(n), two digits"]
    lines += [rf"\newcommand{{\{name}}}{{{one.latex}}}" for name, one in quantities.items()]
    return "\n".join([*lines, ""])
