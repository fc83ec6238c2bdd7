"""One page of all runs: filter, sort, links to their reports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from hjcamp.errors import counted
from hjcamp.report.pages.discrepancy_page import discrepancy_page

# Text sorts as text with numbers in it, so that 10 comes after 9.
SCRIPT = """<script>
const body = document.querySelector("tbody"), rows = [...body.rows];
document.querySelector("input").addEventListener("input", (event) => {
  const words = event.target.value.toLowerCase().split(/\\s+/);
  for (const row of rows) row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
});
document.querySelectorAll("th").forEach((head, k) => head.addEventListener("click", () => {
  const way = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
  document.querySelectorAll("th").forEach((one) => one.removeAttribute("aria-sort"));
  head.setAttribute("aria-sort", way > 0 ? "ascending" : "descending");
  const text = (row) => row.cells[k].textContent;
  rows.sort((a, b) => (!text(a)) - (!text(b)) || way * text(a).localeCompare(text(b), undefined, { numeric: true }));
  body.append(...rows);
}));
</script>"""


def runs_page(columns: Sequence[str], rows: Sequence[Mapping[str, Any]], links: Mapping[str, str]) -> str:
    """Return the HTML; ``links`` lead from the ``run`` of a row to its report, where it has one."""
    head = "".join(f'<th scope="col" style="cursor: pointer">{escape(name)}</th>' for name in columns)
    body = "\n".join(
        "<tr>" + "".join(f"<td>{_cell(name, row[name], links)}</td>" for name in columns) + "</tr>" for row in rows
    )
    field = '<p><input type="search" placeholder="filter runs" aria-label="filter runs"></p>'
    table = f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>'
    return discrepancy_page("Runs", counted(len(rows), "run"), [field, table, SCRIPT])


def _cell(name: str, value: Any, links: Mapping[str, str]) -> str:
    text = "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
    link = links.get(text) if name == "run" else None
    return f'<a href="{escape(link)}">{escape(text)}</a>' if link else escape(text)
