"""The gallery: each answer has a case, each case is what the command gives, and its pictures are there."""

from __future__ import annotations

import contextlib
import re
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from hjcamp import cli

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "gallery"))
import build_gallery  # noqa: E402
from build_gallery import CASES, Case, command, run, shown  # noqa: E402

PAGE = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
#: The cases that take least.
CHEAPEST = ("cannot_tell", "specimen")


def headings(text: str) -> list[str]:
    """Return the lines that begin in capitals: the verdicts."""
    return re.findall(r"^[A-Z]{3}.*$", text, re.MULTILINE)


def test_each_answer_has_a_case_with_its_command_and_picture() -> None:
    assert len(CASES) == PAGE.count("\n## ") == PAGE.count("**Next.**")
    assert len(headings(PAGE)) == sum(case.verb == "diagnose" for case in CASES)
    for case in CASES:
        assert f"$ hjcamp {' '.join(command(case))}\n" in PAGE and f"## {case.title}\n" in PAGE
        assert (ROOT / "docs" / "images" / f"gallery_{case.name}.svg").stat().st_size < 200_000


@pytest.mark.parametrize("case", [one for one in CASES if one.name in CHEAPEST], ids=lambda case: case.name)
def test_a_case_is_what_the_command_gives(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def in_this_process(words: Sequence[str], folder: Path) -> str:
        with contextlib.chdir(folder):
            assert cli.run(list(words)) == 0
        return capsys.readouterr().out

    monkeypatch.setattr(build_gallery, "hjcamp", in_this_process)
    run(case, tmp_path / "case")
    given = shown((tmp_path / "case" / "out.txt").read_text(encoding="utf-8"))
    # of a comparison the line of the model whose constants were estimated
    said = headings(given) or [line.split()[0] for line in given.splitlines() if line.startswith("  calibrated here")]
    assert said and said[0] in PAGE
    assert (tmp_path / "case" / case.verb / case.picture).is_file()


def test_what_all_cases_share_is_left_out_once() -> None:
    text = (
        "  0:47  calibrating (10%)\nEFFECT  a\n        No test was repeated. This\n          goes on\n        Chance: p = 0.1\n"
        "error   over\n  speed  1\npage    x\nnext    y\n"
    )
    assert shown(text) == "EFFECT  a\n        Chance: p = 0.1\nerror   over\n  speed  1\nnext    y"
