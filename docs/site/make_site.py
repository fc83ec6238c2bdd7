"""Build the documentation site: python docs/site/make_site.py [CATALOGUE]

README, the pages of docs/ and the changelog become one site in site/html, with the pages of `hjcamp effects --pages CATALOGUE`
(site/catalogue) beside them. File names in backticks become links. Exit code 1 where a link leads nowhere.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

from follow_links import problems

ROOT = Path(__file__).parents[2]
DOCS, SITE = ROOT / "docs", ROOT / "site"
SOURCE, HTML = SITE / "source", SITE / "html"
COPIED = ("*.md", "*.svg", "*.png", "*.json", "*.ipynb", "*.csv", "*.yaml", "*.py")
MENTIONED = re.compile(r"`(docs/[\w./-]+\.(?:md|ipynb))`")
PARTS = {
    "Begin": ("tour", "tour_plant", "own_plant", "import", "gallery", "commands", "rig", "rig_of_a_plant", "rig_protocol",
              "circle", "sweeps", "tables", "next", "ci", "templates",
              "release"),
    "What was found": ("fidelity", "thesis_gap", "published_inconsistencies", "identification", "further_plants", "pump_cost"),
    "How well it works": ("benchmark", "any_plant", "foreign_machines", "next_value", "identification_recovery", "validation",
                          "convergence", "rig_faults", "bad_calls"),
    "Reference": ("catalogue", "schemas/README", "decisions/README", "limits", "security", "history/README", "changelog"),
}  # fmt: skip
BODY = re.compile(r"</h1>(.*)</body>", re.DOTALL)


def stage(catalogue: Path) -> None:
    """Write the sources of the site: every page at its place, with links that hold there."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    SOURCE.mkdir(parents=True)
    for pattern in COPIED:
        for path in DOCS.rglob(pattern):
            place = SOURCE / path.relative_to(DOCS)
            if "site" not in path.relative_to(DOCS).parts:
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, place)
    shutil.copyfile(ROOT / "README.md", SOURCE / "index.md")
    shutil.copyfile(ROOT / "CHANGELOG.md", SOURCE / "changelog.md")
    (SOURCE / "catalogue.md").write_text(catalogue_page(catalogue), encoding="utf-8")
    for path in SOURCE.rglob("*.md"):
        path.write_text(linked(path.read_text(encoding="utf-8"), path), encoding="utf-8")
    add_contents()


def catalogue_page(catalogue: Path) -> str:
    """Return the list of the catalogue as a page of the site; its links lead to the catalogue's own pages."""
    found = BODY.search((catalogue / "index.html").read_text(encoding="utf-8"))
    assert found is not None, f"{catalogue / 'index.html'} is no page of ours"
    rows = re.sub(r'href="(?!#|\w+:)', 'href="catalogue/', found[1])
    return f"# Effects and plants\n\n```{{raw}} html\n{rows}\n```\n"


def linked(text: str, page: Path) -> str:
    """Return a page with links relative to its place; what stands in blocks of code stays."""
    up = "../" * len(page.relative_to(SOURCE).parent.parts)

    def mention(found: re.Match[str]) -> str:
        place = found[1].removeprefix("docs/")
        return f"[{found[1]}]({up}{place})" if (SOURCE / place).is_file() else found[0]

    pieces = re.split(r"(^```.*?^```[^\n]*$)", text, flags=re.MULTILINE | re.DOTALL)
    for place in range(0, len(pieces), 2):
        pieces[place] = MENTIONED.sub(mention, pieces[place]).replace("](docs/", f"]({up}")
    return "".join(pieces)


def add_contents() -> None:
    """Add the contents to the first page, the decisions and the history; a page that nobody names is an error of Sphinx."""
    known = {name for names in PARTS.values() for name in names}
    rest = [path.stem for path in sorted(SOURCE.glob("*.md")) if path.stem not in known | {"index"}]
    with (SOURCE / "index.md").open("a", encoding="utf-8") as stream:
        for title, names in {**PARTS, "Further": tuple(rest)}.items():
            there = [name for name in names if (SOURCE / f"{name}.md").is_file()]
            if there:
                stream.write("\n```{toctree}\n:hidden:\n:caption: " + title + "\n\n" + "\n".join(there) + "\n```\n")
    for folder, pages in (("decisions", "[a-z]*"), ("history", "**"), ("history/decisions", "[0-9]*")):
        if (SOURCE / folder / "README.md").is_file():
            with (SOURCE / folder / "README.md").open("a", encoding="utf-8") as stream:
                stream.write(f"\n```{{toctree}}\n:hidden:\n:glob:\n\n{pages}\n```\n")


def main(catalogue: Path) -> int:
    """Build the site and check its links; returns the exit code."""
    if not (catalogue / "index.html").is_file():
        print(f"{catalogue}: no catalogue there; make it with: hjcamp effects --pages {catalogue}", file=sys.stderr)
        return 2
    stage(catalogue)
    shutil.rmtree(HTML, ignore_errors=True)
    settings = ["-c", str(Path(__file__).parent), "-W", "--keep-going", "-q", "-d", str(SITE / "doctrees")]
    command = [sys.executable, "-m", "sphinx", "-b", "html", *settings, str(SOURCE), str(HTML)]
    if subprocess.run(command).returncode:
        return 1
    shutil.copytree(catalogue, HTML / "catalogue")
    found = problems(HTML)
    for line in found:
        print(line, file=sys.stderr)
    pages = len(list(HTML.rglob("*.html")))
    print(f"{HTML / 'index.html'}: {pages} pages, {len(found)} links that lead nowhere")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else SITE / "catalogue"))
