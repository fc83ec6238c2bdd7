"""The page of a run in hand as one HTML file: nothing to fetch but its events."""

from __future__ import annotations

from html import escape
from pathlib import Path

from hjcamp.report.pages.explorer import library
from hjcamp.report.pages.template import page_of

HERE = Path(__file__).parent
#: It may speak to its own server, and to nobody else.
POLICY = (
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; connect-src 'self'; img-src data:\">"
)


def page_html(title: str) -> str:
    """Return the page."""
    style = f"\n{library('uPlot.min.css')}\n{(HERE / 'live.css').read_text(encoding='utf-8')}"
    content = f"""<header>
<h1 id="name">{escape(title)}</h1>
<span id="state" class="pill" role="status">waiting</span>
<p id="facts" class="soft"></p>
</header>
<div id="progress" role="progressbar" aria-label="tests done"><div></div><div class="failed"></div></div>
<p id="words" class="verdict" hidden></p>
<p id="stop" class="soft">Stop: Ctrl-C in the terminal of the run. Once: after the test in hand; twice: now.</p>
<main>
<section aria-label="test in hand">
<div class="now"><b id="test">no test yet</b> <span id="phase" class="pill" hidden></span> <span id="clock" class="soft"></span></div>
<div id="plots"></div>
</section>
<section aria-label="limits">
<h2>Limits</h2>
<p id="nolimits" class="soft">None is known yet.</p>
<div id="limits"></div>
<h2>Conditions</h2>
<div class="scroll"><table id="conditions">
<thead><tr><th>condition</th><th>tests</th><th>RMS error</th></tr></thead><tbody></tbody>
</table></div>
</section>
</main>
<noscript><p>This page needs JavaScript.</p></noscript>
<script>{library("uPlot.iife.min.js")}</script>
<script>{(HERE / "live.js").read_text(encoding="utf-8")}</script>"""
    return page_of(title, content, kind="live", style=style, policy=POLICY, head='<link rel="icon" href="data:,">\n')
