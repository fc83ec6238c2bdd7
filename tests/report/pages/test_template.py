"""A report by a user's template: our page with parts of it changed, values escaped, and refusals with file and line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from report_samples import make_logs

from hjcamp.errors import UsageError
from hjcamp.report.build import build_report
from hjcamp.report.pages.page import Picture, build_page

ROOT = Path(__file__).parents[3]
EXAMPLE = re.findall(r"```jinja\n(.*?)```", (ROOT / "docs" / "templates.md").read_text(encoding="utf-8"), re.DOTALL)[0]


def page(template: Path | None = None, **values: object) -> str:
    given: dict = {
        "title": "a <b>", "facts": ["5 < 6", "x"], "verdict": "1 & 2", "sheets": [], "origin": [("who", "<i>")],
        "pictures": {"ramp_pos__pid": Picture("7 tests", lambda: '<svg viewBox="0 0 9 9"></svg>')}, "command": "a && b",
        "configuration": "x: <y>", "template": template,
    }  # fmt: skip
    return "".join(build_page(**given | values))


def test_every_value_is_escaped() -> None:
    text = page()
    for value in ("a &lt;b&gt;", "5 &lt; 6 · x", "1 &amp; 2", "&lt;i&gt;", "a &amp;&amp; b", "x: &lt;y&gt;"):
        assert value in text, value
    assert "<b>" not in text and "<i>" not in text and text.count("<svg ") == 1


def test_the_example_of_the_docs_changes_parts_of_the_page(tmp_path: Path) -> None:
    (tmp_path / "lab.html").write_text(EXAMPLE, encoding="utf-8")
    text = build_report_page(tmp_path, tmp_path / "lab.html")
    assert "hydraulics laboratory</title>" in text and "color: #004488" in text
    assert 'id="explorer"' not in text and re.search(r"<p>.+: \d+ rows</p>", text) and "<details>" in text
    assert "Content-Security-Policy" in text and 'id="origin"' in text


def build_report_page(folder: Path, template: Path) -> str:
    made = build_report(folder, logs=make_logs(2), output=folder / "out", template=template)
    return made.page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a\n{{ nothing }}", "line 2: 'nothing' is undefined"),
        ("a\nb\n{% block %}", "line 3"),
        ("{% for x in %}", "line 1"),
        ('{% extends "other.html" %}', "other.html"),
        ('{% include "../../../etc/passwd" %}', "passwd"),
        ("a\n{{ title.__class__ }}", "line 2: access to attribute '__class__'"),
        ("{{ facts.append(1) }}", "append"),
        ("{{ pictures[0].html.__globals__ }}", "__globals__"),
        ("{{ 1 / 0 }}", "division"),
        ("{{ range(10000000) }}", "range"),
        ("{{ facts[99] }}", "line 1"),
    ],
)
def test_a_template_that_fails_is_one_sentence_and_the_old_page_stays(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "bad.html").write_text(text, encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        page(tmp_path / "bad.html")
    assert said in str(caught.value) and "bad.html" in str(caught.value) and "\n" not in str(caught.value)


def test_what_is_no_text_or_not_there_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bytes.html").write_bytes(b"\xff\xfe")
    for name in ("bytes.html", "none.html", "."):
        with pytest.raises(UsageError, match="cannot be read"):
            page(tmp_path / name)


def test_a_failure_leaves_the_page_that_was_there(tmp_path: Path) -> None:
    (tmp_path / "bad.html").write_text("half\n{{ nothing }}", encoding="utf-8")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "report.html").write_text("old", encoding="utf-8")
    with pytest.raises(UsageError, match="line 2"):
        build_report_page(tmp_path, tmp_path / "bad.html")
    assert (tmp_path / "out" / "report.html").read_text() == "old"
    assert not list((tmp_path / "out").glob("*.part"))
