"""Names as a reader of a text wants them, and as LaTeX takes them."""

from __future__ import annotations

import re
from collections.abc import Iterable

from hjcamp.report.tables.formats import escape_latex
from hjcamp.report.wording.names import readable

TITLES = {
    "RMSE1": r"RMSE\textsubscript{1}",
    "RMSE2": r"RMSE\textsubscript{2}",
    "|e|max": r"$|e|_\mathrm{max}$",
    "SSE": "SSE",
    "|SSE|": r"$|\mathrm{SSE}|$",
    "n": "$n$",
}
MACROS = {"rmse1_deg": "RmseOne", "rmse2_deg": "RmseTwo", "e_max_deg": "EMax", "sse_deg": "Sse"}
DIGITS = ("Zero", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine")


def header(text: str) -> str:
    """Return the heading of a column in LaTeX."""
    return TITLES.get(text) or escape_latex(readable(text)[:1].upper() + readable(text)[1:])


def macro(*parts: str) -> str:
    r"""Return the name of a macro, of letters alone: ``ramp_pos``, ``pid`` is RampPosPid."""
    text = re.sub(r"(\d)hz\b", r"\1Hz", re.sub(r"(\d)p(\d)", r"\1Point\2", "_".join(parts)).replace("hz_", "Hz_"))
    words = re.split(r"[^A-Za-z0-9]+", text)
    spelt = [re.sub(r"\d", lambda found: DIGITS[int(found[0])], word) for word in words if word]
    return "".join(word[0].upper() + word[1:] for word in spelt)


def distinct(names: Iterable[str]) -> list[str]:
    """Return the names, each told from those before it by letters."""
    taken: set[str] = set()
    found = []
    for name in names:
        one, number = name, 0
        while one in taken:
            number += 1
            one = f"{name}{'X' * number}"
        taken.add(one)
        found.append(one)
    return found
