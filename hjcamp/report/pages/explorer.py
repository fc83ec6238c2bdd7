"""The explorer as HTML: one block of a page with its library, its points and nothing to fetch."""

from __future__ import annotations

import json
from functools import lru_cache
from html import escape
from importlib import resources
from pathlib import Path

from hjcamp.report.pages.exploration import Exploration

HERE = Path(__file__).parent
KEYS = (
    "Drag: zoom, double click: back. Click: cursor A, then B, then the nearer of them moves; the tables below the plots say "
    "what the points from A to B do. Keys: left and right arrow, other test; + and -, zoom; 0, whole test; "
    "1 to 9, models; m, what was {observed}; r, repetitions; a and b, cursors at the pointer; Escape, none."
)


def explorer_html(shown: Exploration, title: str = "Every test") -> str:
    """Return the explorer of a page, which `page.css` dresses; nothing where there is no test."""
    if not shown.tests:
        return ""
    told = shown.head()
    head = json.dumps(told, allow_nan=False).replace("<", "\\u003c")
    keys = KEYS.format(observed=told["observed"])
    if told["averaged"] > 1:
        keys += f" A point of a curve is the mean of {told['averaged']} samples; errors are of all samples."
    return f"""<section id="explorer" class="explorer" aria-label="{escape(title)}">
<h2 id="tests">{escape(title)}</h2>
<style>{library("uPlot.min.css")}
{(HERE / "explorer.css").read_text(encoding="utf-8")}</style>
<noscript><p class="soft">This part needs JavaScript; the pictures below do not.</p></noscript>
<div class="bar" role="toolbar"></div>
<div class="split"><div class="list"></div><div class="plots"></div></div>
<p class="soft keys">{escape(keys)}</p>
<script type="application/json" id="explorer-head">{head}</script>
<script type="text/plain" id="explorer-points">{shown.points()}</script>
<script>{library("uPlot.iife.min.js")}</script>
<script>{(HERE / "explorer_cursors.js").read_text(encoding="utf-8")}</script>
<script>{(HERE / "explorer.js").read_text(encoding="utf-8")}</script>
</section>
"""


@lru_cache(maxsize=2)
def library(name: str) -> str:
    """Return a file of uPlot, led by its licence, safe inside a page."""
    place = resources.files("hjcamp.report") / "uplot"
    licence = (place / "LICENSE").read_text(encoding="utf-8")
    text = (place / name).read_text(encoding="utf-8").replace("</script", "<\\/script")
    return f"/*! uPlot\n{licence}\n*/\n{text}"
