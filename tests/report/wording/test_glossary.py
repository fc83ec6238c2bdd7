"""The words of the answers: one sentence each, found by any spelling, and shown on the pages."""

from __future__ import annotations

import re
from html import escape

import pytest

from hjcamp import cli
from hjcamp.report.pages.discrepancy_page import bullets, discrepancy_page, note
from hjcamp.report.wording.glossary import ALSO, EVERYDAY, WORDS, glossed, plain_word


def test_every_word_is_one_sentence_and_every_other_name_leads_to_one() -> None:
    for word, said in WORDS.items():
        assert said.endswith(".") and ". " not in said, word
        assert plain_word(word) == word
    assert set(ALSO.values()) <= set(WORDS) and not set(ALSO) & set(WORDS)
    assert set(WORDS) | set(ALSO) >= EVERYDAY


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ("floor", "noise floor"),
        ("NOISE_FLOOR", "noise floor"),
        ("free law", "non-parametric term"),
        ("runs away", "diverges"),
        ("chapters left out", "block"),
        ("told apart", "distinguishable"),
        ("left", "residual share"),
        ("Surrogate data", "surrogate data"),
        ("LAW_LEFT", "law left"),
        ("held out", "held-out"),
        ("outside_library", "outside the library"),
        ("confidence_set", "confidence set"),
        ("twins", "null replicate"),
    ],
)
def test_explain_finds_a_word_however_it_is_written(asked: str, found: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["explain", *asked.split()]) == 0
    assert " ".join(capsys.readouterr().out.split()) == f"{found}: {WORDS[found]}"


def test_explain_names_the_nearest_word_and_lists_all(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["explain", "flor"]) == 2
    assert "did you mean 'floor'" in capsys.readouterr().err
    assert cli.run(["explain"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert all(f"{word}: " in out for word in WORDS)


def test_a_page_explains_its_words_once_each_and_no_others() -> None:
    assert glossed("The noise floor and the noise floor < 1") == (
        f'The <abbr title="{escape(WORDS["noise floor"])}">noise floor</abbr> and the noise floor &lt; 1'
    )
    assert glossed("floored, window-sill") == "floored, window-sill"
    html = discrepancy_page("A page", "", [bullets(["p-value of held-out blocks"]), note("noise floor unknown & more")])
    listed = re.findall(r"<dt>([^<]*)</dt>", html)
    assert listed == ["noise floor", "block", "p-value"]
    assert "<dl>" not in discrepancy_page("Another", "", [note("nothing of this")])


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("path", "path: path(flow, upstream=None, downstream=None"),
        ("state", "State: State(unit, resolution=0.0, typical=1.0"),
        ("contact", "``load`` are what effects may let friction depend on"),
        ("PART", "part: part(function, *given, **named)"),
    ],
)
def test_explain_says_what_a_word_of_a_plants_file_takes(asked: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["explain", asked]) == 0
    assert said in " ".join(capsys.readouterr().out.split())
    assert cli.run(["explain", "pth"]) == 2
    assert "did you mean 'path'" in capsys.readouterr().err


def test_an_effect_is_no_word_of_the_answers(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["explain", "spill", "over"]) == 2
    assert "hjcamp effects spill_over" in capsys.readouterr().err
