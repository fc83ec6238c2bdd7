"""The documentation site: every page of docs/ has a place in it, mentions become links, and a link that leads nowhere is found."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """Return the script, with its sources staged in an empty folder."""
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "site"))
    import make_site

    monkeypatch.setattr(make_site, "SOURCE", tmp_path / "source")
    catalogue = tmp_path / "catalogue"
    catalogue.mkdir()
    catalogue.joinpath("index.html").write_text('<body><h1>All</h1><a href="leakage.html">leakage</a></body>')
    make_site.stage(catalogue)
    yield make_site
    for name in ("make_site", "follow_links"):
        sys.modules.pop(name, None)


def test_every_page_has_a_place_and_mentions_lead_there(site: ModuleType) -> None:
    contents = (site.SOURCE / "index.md").read_text(encoding="utf-8")
    for page in (ROOT / "docs").glob("*.md"):
        assert f"\n{page.stem}\n" in contents, page
    assert "](docs/" not in contents and "](rig.md)" in contents
    assert '<a href="catalogue/leakage.html">' in (site.SOURCE / "catalogue.md").read_text(encoding="utf-8")
    page = site.SOURCE / "decisions" / "rig.md"
    text = "see `docs/rig.md`, `docs/decisions/live.md` and `docs/none.md`\n```\n`docs/rig.md`\n```\n"
    expected = text.replace("`docs/rig.md`,", "[docs/rig.md](../rig.md),")
    expected = expected.replace("`docs/decisions/live.md`", "[docs/decisions/live.md](../decisions/live.md)")
    assert site.linked(text, page) == expected


def test_what_leads_nowhere_is_found(site: ModuleType, tmp_path: Path) -> None:
    folder = tmp_path / "html"
    (folder / "a").mkdir(parents=True)
    (folder / "index.html").write_text(
        '<a href="a/x.html#here">x</a> <a href="https://elsewhere.example">y</a> <a href="#top">t</a>'
    )
    (folder / "a" / "x.html").write_text(
        '<b id="here"></b><a href="../index.html#gone">z</a><img src="none.png">'
        '<script src="https://elsewhere.example/x.js"></script>'
    )
    assert site.problems(folder) == [
        "a/x.html: ../index.html#gone has no such place",
        "a/x.html: none.png is not there",
        "a/x.html: loads https://elsewhere.example/x.js",
        "index.html: #top has no such place",
    ]
