"""Open the newest page of a run, or of all that is in a folder, in the browser."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from hjcamp.errors import HjcampError, UsageError, counted
from hjcamp.storage import check_place, shown_path

REPORT, PAGE = "report.html", "index.html"
DEEPEST = 6
# In so many letters at its begin a page of ours says that it loads nothing; an index.html of another program does not.
BEGIN = 1000


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("open")(open_)


def open_(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="A page, a run, a shared run (ZIP), or any folder.")] = Path("."),
    into: Annotated[Path | None, typer.Option(help="Of a shared run: its new folder; the archive's name by default.")] = None,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open it, or only say which it is.")] = True,
) -> None:
    """Open the page that was written last (report, compare, diagnose, add), of a run or anywhere in a folder.

    A ZIP of hjcamp share is checked and unpacked; nothing in it is run, and nothing is written outside its new folder.
    """
    from hjcamp.live.browser import has_windows, opened

    if not path.exists():
        raise UsageError(f"{shown_path(path)}: no such file or folder")
    if path.is_file() and path.suffix.lower() == ".zip":
        unpack(path, into or Path(path.stem))
        return
    if into is not None:
        raise UsageError(f"--into {shown_path(into)}: it is of a shared run, a ZIP")
    if path.is_file() and path.suffix.lower() != ".html":
        raise UsageError(f"{shown_path(path)} is no page; give a page, a run or a folder of runs")
    page = path if path.is_file() else max(pages_below(path), key=lambda one: (one.stat().st_mtime_ns, str(one)), default=None)
    if page is None:
        raise UsageError(f"no page in {shown_path(path)}; hjcamp report RUN, compare and diagnose write one")
    print(page)
    if browser and not (has_windows() and opened(page.resolve().as_uri())):
        print("no browser could be opened here")


def unpack(source: Path, into: Path) -> None:
    """Unpack a shared run, check its logs, and say what is there."""
    from hjcamp.campaign.files.shared_run import open_shared
    from hjcamp.records.recover import verify_log

    check_place(into, "--into", folder=True)
    files = open_shared(source, into)
    logs = [verify_log(one) for one in files if one.suffix == ".mcap"]
    broken = [one for one in logs if not one.whole]
    print(
        f"{into}: {counted(len(files), 'file')}, each as described; {len(logs) - len(broken)} of {counted(len(logs), 'log')} whole"
    )
    print(f"next  hjcamp report {into}")
    if broken:
        raise HjcampError(f"{broken[0].path}: {broken[0].problems[0]}")


def pages_below(folder: Path) -> Iterator[Path]:
    """Yield the pages in a folder; no link is followed, and nothing hidden is looked into."""
    for place, folders, files in os.walk(folder):
        deep = len(Path(place).relative_to(folder).parts)
        folders[:] = [one for one in folders if not one.startswith(".")] if deep < DEEPEST else []
        for name in {REPORT, PAGE}.intersection(files):
            page = Path(place, name)
            if page.is_file() and not page.is_symlink() and (name == REPORT or _ours(page)):
                yield page


def _ours(page: Path) -> bool:
    from hjcamp.report.pages.template import NOTHING_FETCHED

    try:
        with page.open(encoding="utf-8", errors="replace") as stream:
            return NOTHING_FETCHED in stream.read(BEGIN)
    except OSError:
        return False
