"""Printed texts and pages are in the field's words and hold no private one; names and docstrings hold ever fewer."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
#: A private word, and the field's.
PRIVATE = {
    r"chapters? (?!\d|of the thesis)": "block, cross-validation fold",
    r"alike": "similar, replicate, equally",
    r"anew": "again",
    r"twins?": "null replicates",
    r"moved in time": "circularly shifted",
    r"(?:told|tells?|telling)(?: \w+){0,2} apart": "distinguishable, to distinguish",
    r"can(?:not)? be told": "identifiable, can be identified",
    r"(?<!noise )floors?": "repeatability, noise floor",
    r"free laws?": "non-parametric term",
    r"(?:runs?|ran|running) away": "diverges",
    r"swings (?:by|at|with)": "oscillates",
    r"beside": "with, in addition to, relative to, next to",
    r"what is left": "the residual",
    r"excess error": "error above repeatability",
    r"born": "grows within the first",
    r"forms? of friction": "friction variant",
}
#: Places where a private word may stand, by file and part of the text, and why.
ALLOWED: dict[tuple[str, str], str] = {
    ("hjcamp/report/wording/glossary.py", ""): "old words are still answered by explain",
    ("hjcamp/diagnosis/candidates/nonparametric_laws.py", "floor("): "a function of the equations' language",
    ("docs/templates.md", "`beside`"): "a name that templates of users have",
}
#: So many private words stand in names and docstrings of the product; it may fall, not rise.
MOST_IN_CODE = 276


@cache
def pattern() -> re.Pattern[str]:
    """The private words as one pattern, each in a group of its own."""
    return re.compile("|".join(rf"(\b{word}\b)" if word[-1] != ")" else rf"(\b{word})" for word in PRIVATE), re.IGNORECASE)


def private_words(text: str) -> list[str]:
    """Each private word of a text, with what the field says."""
    said = list(PRIVATE.values())
    return [f"'{found[0]}': say {said[(found.lastindex or 1) - 1]}" for found in pattern().finditer(text)]


def trees() -> Iterator[tuple[str, ast.Module]]:
    """The product's modules."""
    for path in sorted((ROOT / "hjcamp").rglob("*.py")):
        yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def docstrings(tree: ast.Module) -> dict[int, str]:
    """The texts that are statements of their own, by the identity of their node."""
    texts = (node.value for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
    return {id(one): one.value for one in texts if isinstance(one.value, str)}


def printed() -> Iterator[tuple[str, str]]:
    """Every text of the product with a blank in it, outside docstrings, with its place: one without is a key or a name."""
    for name, tree in trees():
        own = docstrings(tree)
        inner = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
        for node in ast.walk(tree):
            text = (
                "".join(getattr(part, "value", "") if isinstance(part, ast.Constant) else "0" for part in node.values)
                if isinstance(node, ast.JoinedStr)
                else node.value
                if isinstance(node, ast.Constant) and id(node) not in inner
                else None
            )
            if isinstance(text, str) and " " in text and id(node) not in own:
                yield f"{name}:{getattr(node, 'lineno', 0)}", text


def pages() -> Iterator[tuple[str, str]]:
    """The README and the pages under docs, line by line."""
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            yield f"{path.relative_to(ROOT).as_posix()}:{number}", line


@pytest.mark.parametrize("texts", [printed, pages], ids=["printed texts", "pages"])
def test_what_users_read_holds_no_private_word(texts: object) -> None:
    found = [
        f"{place}: {word}   {text.strip()[:160]}"
        for place, text in texts()  # type: ignore[operator]
        for word in private_words(text)
        if not any(place.startswith(f"{file}:") and part in text for file, part in ALLOWED)
    ]
    assert not found, "\n" + "\n".join(found)


def test_names_and_docstrings_hold_ever_fewer_private_words() -> None:
    assert in_code() <= MOST_IN_CODE


def in_code() -> int:
    """How many private words the names (split at ``_``) and the docstrings of the product hold."""
    count = 0
    for _, tree in trees():
        names = [
            getattr(node, field)
            for node in ast.walk(tree)
            for field in ("id", "name", "attr", "arg")
            if isinstance(getattr(node, field, None), str)
        ]
        texts = [*docstrings(tree).values(), *(name.strip("_").replace("_", " ") for name in names)]
        count += sum(len(private_words(text)) for text in texts)
    return count


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("3 times the floor", 1),
        ("3 times the noise floor", 0),
        ("chapter 4", 0),
        ("of chapters left out", 1),
        ("no test tells the two apart", 1),
        ("runs away, beside a twin", 3),
        ("is left out", 0),
        ("telling", 0),
    ],
)
def test_a_private_word_is_found_as_a_whole(text: str, words: int) -> None:
    assert len(private_words(text)) == words
