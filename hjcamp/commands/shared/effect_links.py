"""What the page of a diagnosis says of effects beyond numbers: their equations, a page of each, and pages next to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from hjcamp.storage import whole_file

if TYPE_CHECKING:
    from hjcamp.model.declare.effect import Effect

PREFIX = "effect_"
OTHER_PAGES = (("compare", "compare/index.html"), ("report", "report.html"), ("add", "add/index.html"))


def equations_of(names: Sequence[str], library: Mapping[str, type[Effect]]) -> str:
    """Return the first equation of each named effect as MathML, with a link to its page."""
    from hjcamp.report.pages.catalogue_page import equations
    from hjcamp.report.wording.mathml import mathml

    parts = []
    for name in names:
        found = equations(library[name])
        drawn = mathml(found[0]) if found else ""
        parts.append(f'<h3><a href="{PREFIX}{name}.html">{name}</a></h3><p>{escape(library[name].sentence())}</p>{drawn}')
    return "\n".join(parts)


def write_effect_pages(folder: Path, names: Sequence[str], library: Mapping[str, type[Effect]]) -> None:
    """Write the page of each effect that is a candidate next to the diagnosis."""
    from hjcamp.report.pages.catalogue_page import EffectEntry, effect_page

    for name in dict.fromkeys(names):
        html = effect_page(EffectEntry(name, library[name]), back="")
        with whole_file(folder / f"{PREFIX}{name}.html") as stream:
            stream.write(html.encode())


def links(folder: Path) -> str:
    """Return links to the pages of the same run that are there."""
    found = [(name, f"../{place}") for name, place in OTHER_PAGES if (folder.parent / place).is_file()]
    if not found:
        return ""
    return "<p>" + " · ".join(f'<a href="{place}">{name}</a>' for name, place in found) + "</p>"
