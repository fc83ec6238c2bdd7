"""The catalogue as pages: one for each effect and each plant, from what their files say of themselves."""

from __future__ import annotations

import inspect
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from hjcamp.model.declare.effect import Effect
from hjcamp.model.declare.parameter import Parameter
from hjcamp.model.files.docstring import docstring_sentence
from hjcamp.report.pages import discrepancy_page as page
from hjcamp.report.wording.mathml import mathml
from hjcamp.report.wording.units import shown

PARAMETERS = ("parameter", "unit", "default", "bounds", "absent at", "meaning")
LABELS = ("Seen as", "Not for", "Source", "Sources", "Valid")


@dataclass(frozen=True)
class EffectEntry:
    """One effect of the catalogue: its name on a plant (any where empty), and a picture (SVG) where one was drawn."""

    name: str
    effect: type[Effect]
    plants: Sequence[str] = ()
    picture: str = ""
    caption: str = ""


def equations(kind: type) -> list[str]:
    """Return the text of every ``.. math::`` block of a docstring, in order."""
    text = inspect.cleandoc(kind.__doc__ or "")
    found = re.findall(r"^\.\. math:: ?(.*(?:\n[ \t]+.*)*)", text, re.MULTILINE)
    return [" ".join(one.split()) for one in found]


def described(kind: type, known: Collection[str] = (), ending: str = ".html") -> str:
    """Return a docstring as HTML: sentences, equations as MathML, its labelled lines, names of ``known`` effects as links."""
    parts: list[str] = []
    text = re.sub(r"^\.\. math:: ?", "\n.. math:: ", inspect.cleandoc(kind.__doc__ or ""), flags=re.MULTILINE)
    text = re.sub(rf"^({'|'.join(LABELS)}):", r"\n\1:", text, flags=re.MULTILINE)
    for block in re.split(r"\n\s*\n", text):
        whole = " ".join(block.split())
        if whole.startswith(".. math::"):
            parts.append(mathml(whole.removeprefix(".. math::").strip()))
            continue
        label, colon, rest = whole.partition(":")
        body = _linked(rest.strip() if colon and label in LABELS else whole, known, ending)
        parts.append(f"<p><b>{label}:</b> {body}</p>" if colon and label in LABELS else f"<p>{body}</p>")
    return "\n".join(part for part in parts if part != "<p></p>")


def _linked(text: str, known: Collection[str], ending: str) -> str:
    marked = re.sub(r"``?([^`]+)``?", r"\1", text)
    words = re.split(r"\b([a-z][a-z0-9_]*)\b", marked)
    linked = [f'<a href="{word}{ending}">{word}</a>' if "_" in word and word in known else escape(word) for word in words]
    joined = "".join(linked)
    # a name of one word is a link only where the text points at it
    for word in re.findall(r"see ([a-z]+)", marked):
        if word in known and "_" not in word:
            joined = joined.replace(f"see {word}", f'see <a href="{word}{ending}">{word}</a>', 1)
    return joined


def effect_page(entry: EffectEntry, known: Collection[str] = (), back: str = "index.html") -> str:
    """Return the page of one effect; ``known`` are the effects with a page next to it."""
    effect = entry.effect
    where = f"acts on each {effect.acts_on}" if effect.acts_on else f"acts on the {effect.subsystem}"
    fits = f"; fits {', '.join(entry.plants)}" if entry.plants else ""
    parts = [
        f'<p class="soft">{escape(where)}: {escape(", ".join(effect.terms))}{escape(fits)}</p>',
        described(effect, known),
        page.picture(entry.caption, entry.picture) if entry.picture else "",
        page.heading("Parameters"),
        page.table_of(PARAMETERS, [_row(one) for one in effect.parameters.values()]),
        page.note("Units and numbers are those of the place on which it acts.") if effect.acts_on else "",
        f"<pre>hjcamp effects {escape(entry.name)}</pre>",
        f'<p><a href="{back}">All effects and plants</a></p>' if back else "",
    ]
    return page.discrepancy_page(entry.name, "", parts)


def _row(one: Parameter) -> list[str]:
    low, high = one.bounds
    absent = "" if one.off is None else f"{one.off:g}"
    return [one.name, one.unit, f"{one.default:.4g}", f"{low:.4g} ... {high:.4g}", absent, one.text]


def plant_page(
    name: str,
    plant: type,
    values: Sequence[Sequence[str]],
    places: Sequence[Sequence[str]],
    effects: Mapping[str, str],
    unfit: Mapping[str, str],
) -> str:
    """Return the page of one plant: its equation and source, parameters, places, effects that fit and why others do not."""
    fitting = "".join(f'<li><a href="{one}.html">{one}</a>: {escape(said)}</li>' for one, said in effects.items())
    parts = [
        described(plant),
        page.heading("Parameters"),
        page.table_of(("parameter", "unit", "value", "meaning"), values),
        page.heading("Places where effects act"),
        page.table_of(("place", "kind", "offers"), places),
        page.heading("Effects that fit"),
        f"<ul>{fitting}</ul>",
        page.heading("Effects that do not, and why") if unfit else "",
        page.bullets(list(unfit.values())),
        f"<pre>hjcamp plants {escape(name)}</pre>",
        '<p><a href="index.html">All effects and plants</a></p>',
    ]
    return page.discrepancy_page(name, "", parts)


def index_page(effects: Sequence[EffectEntry], plants: Mapping[str, type]) -> str:
    """Return the page that links all others: effects by what they act on, and plants."""
    groups: dict[str, list[EffectEntry]] = {}
    for one in effects:
        groups.setdefault(one.effect.acts_on or one.effect.subsystem, []).append(one)
    parts = []
    for group, members in groups.items():
        rows = "".join(f'<li><a href="{one.name}.html">{one.name}</a>: {escape(one.effect.sentence())}</li>' for one in members)
        parts += [page.heading(f"On: {group}"), f"<ul>{rows}</ul>"]
    listed = "".join(
        f'<li><a href="plant_{name}.html">{name}</a>: {escape(docstring_sentence(plant))}</li>'
        for name, plant in plants.items()
    )
    return page.discrepancy_page("Effects and plants", "", [*parts, page.heading("Plants"), f"<ul>{listed}</ul>"])


def parameter_rows(parameters: Mapping[str, Parameter]) -> list[list[str]]:
    """Return the rows of a plant's parameters as people read them."""
    rows = []
    for name, one in parameters.items():
        value, unit = shown(one.default, one.unit)
        rows.append([name, unit, f"{value:.4g}", one.text])
    return rows
