"""The explorer as HTML: one block of a page with its library, its points and nothing to fetch."""

from __future__ import annotations

import json
from functools import lru_cache
from html import escape
from importlib import metadata
from pathlib import Path

from hjcamp.errors import HjcampError
from hjcamp.report.exploration import Exploration

HERE = Path(__file__).parent
LIBRARY = "uplot-python"
#: What a page may load: itself. A browser holds it to that.
NOTHING_FETCHED = (
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; img-src data:\">"
)
KEYS = (
    "Drag: zoom, double click: back. Keys: left and right arrow, other test; + and -, zoom; 0, whole test; "
    "1 to 9, models; m, what was {observed}; r, repetitions."
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
<script>{library("uPlot.iife.js")}</script>
<script>{(HERE / "explorer.js").read_text(encoding="utf-8")}</script>
</section>
"""


@lru_cache(maxsize=4)
def library(name: str) -> str:
    """Return a file of the plotting library as its Python package carries it, safe inside a page."""
    try:
        # Importing the package would import IPython.
        place = Path(str(metadata.distribution(LIBRARY).locate_file(f"uplot/static/{name}")))
        text = place.read_text(encoding="utf-8")
    except (metadata.PackageNotFoundError, OSError) as error:
        raise HjcampError(f"the package {LIBRARY} is not whole ({error}); install hjcamp again") from error
    return text.replace("</script", "<\\/script")
