"""Say what a word of the answers means, in one sentence: floor, surrogate data, posterior weight, ..."""

from __future__ import annotations

from typing import Annotated

import typer

from hjcamp.commands._session import AnswerFile
from hjcamp.errors import UsageError, unknown


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("explain")(explain)


def explain(
    word: Annotated[
        list[str] | None,
        typer.Argument(help="A word, such as floor or 'posterior weight'; none for all of them.", show_default=False),
    ] = None,
    json: AnswerFile = None,
) -> None:
    """Say what a word of the answers means, in one sentence."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._session import check_answer_file, write_answer
    from hjcamp.commands._wrapped import print_wrapped
    from hjcamp.effects import effect_files
    from hjcamp.report.glossary import ALSO, WORDS, plain_word

    check_answer_file(json)
    asked = " ".join(word or [])
    found = plain_word(asked)
    if asked and found not in WORDS and (name := asked.replace(" ", "_")) in effect_files():
        raise UsageError(f"'{name}' is an effect, no word of the answers: hjcamp effects {name}")
    if asked and found not in WORDS:
        raise unknown("word", asked, {*WORDS, *ALSO})
    told = {found: WORDS[found]} if asked else dict(WORDS)
    write_answer(json, {"schema": "hjcamp.words/1", "words": told})
    console = make_console()
    for name, said in told.items():
        print_wrapped(console, [f"{name}: {said}"], 2)
