"""`hjcamp open`: which page is the newest, what is no page, and that no browser is no failure."""

from __future__ import annotations

import os
import webbrowser
from collections.abc import Callable
from pathlib import Path

import pytest

from hjcamp import cli
from hjcamp.report.pages.template import NOTHING_FETCHED

OURS = f"<!DOCTYPE html>\n<html><head>{NOTHING_FETCHED}</head></html>"
PAGES = {
    "runs/a/report.html": (OURS, 1), "runs/a/compare/index.html": (OURS, 2), "runs/b/report.html": ("by a template", 3),
    "site/index.html": ("<html>of another program</html>", 4), ".hidden/report.html": (OURS, 5), "notes.html": (OURS, 6),
    "1/2/3/4/5/6/7/report.html": (OURS, 7),
}  # fmt: skip


@pytest.fixture
def pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, (text, when) in PAGES.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(text)
        os.utime(name, (when, when))
    Path("runs/c").mkdir()
    Path("runs/c/report.html").symlink_to(tmp_path / "notes.html")
    Path("log.mcap").write_bytes(b"")
    return tmp_path


@pytest.mark.parametrize(
    ("path", "code", "said"),
    [
        ("", 0, "runs/b/report.html"),
        ("runs", 0, "runs/b/report.html"),
        ("runs/a", 0, "runs/a/compare/index.html"),
        ("notes.html", 0, "notes.html"),
        ("site", 2, "no page in site; hjcamp report RUN, compare and diagnose write one"),
        ("runs/c", 2, "no page in runs/c"),
        ("nothing", 2, "nothing: no such file or folder"),
        ("log.mcap", 2, "log.mcap is no page; give a page, a run or a folder of runs"),
    ],
)
def test_the_newest_page_is_opened(
    pages: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], path: str, code: int, said: str
) -> None:
    monkeypatch.setenv("BROWSER", "one")
    shown: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda address: shown.append(address) or True)
    assert cli.run(["open", *([path] if path else [])]) == code
    out, err = capsys.readouterr()
    assert said in (err if code else out)
    assert shown == ([] if code else [(pages / said).as_uri()])


@pytest.mark.parametrize("fails", [lambda address: False, lambda address: (_ for _ in ()).throw(webbrowser.Error("none"))])
def test_without_a_browser_the_page_is_named(
    pages: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], fails: Callable[[str], bool]
) -> None:
    monkeypatch.setenv("BROWSER", "one")
    monkeypatch.setattr(webbrowser, "open", fails)
    assert cli.run(["open", "runs/a"]) == 0
    assert capsys.readouterr().out == "runs/a/compare/index.html\nno browser could be opened here\n"
    assert cli.run(["open", "runs/a", "--no-browser"]) == 0
    assert capsys.readouterr().out == "runs/a/compare/index.html\n"
