"""Find links of a folder of HTML pages that lead nowhere, and what a page would fetch from elsewhere."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: Attributes that load something at once; a link is followed only by who clicks on it.
LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("source", "src")}
NAVIGATION = ("canonical", "search", "next", "prev", "index", "genindex", "author", "help", "copyright", "top")


class Page(HTMLParser):
    """The anchors of one page and what it leads to or loads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[tuple[str, bool]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note ids, links and what is loaded."""
        given = dict(attrs)
        self.anchors |= {value for name in ("id", "name") if (value := given.get(name))}
        for name in ("href", "src"):
            if value := given.get(name):
                loads = (tag, name) in LOADED and given.get("rel") not in NAVIGATION
                self.links.append((value, loads))


def problems(folder: Path) -> list[str]:
    """Return one line for each link inside ``folder`` that leads nowhere and for each thing loaded from elsewhere."""
    pages = {path.resolve(): Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    found = []
    for path, page in pages.items():
        where = path.relative_to(folder.resolve())
        for link, loads in page.links:
            split = urlsplit(link)
            if split.scheme or split.netloc:
                if loads and split.scheme != "data":
                    found.append(f"{where}: loads {link}")
                continue
            target = (path.parent / unquote(split.path)).resolve() if split.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file():
                found.append(f"{where}: {link} is not there")
            elif split.fragment and target in pages and unquote(split.fragment) not in pages[target].anchors:
                found.append(f"{where}: {link} has no such place")
    return found
