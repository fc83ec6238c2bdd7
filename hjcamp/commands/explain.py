"""Say what a word of the answers means, in one sentence: floor, surrogate data, posterior weight, ..."""

from __future__ import annotations

from typing import Annotated

import typer

from hjcamp.errors import unknown


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("explain")(explain)


def explain(
    word: Annotated[
        list[str] | None,
        typer.Argument(help="A word, such as floor or 'posterior weight'; none for all of them.", show_default=False),
    ] = None,
) -> None:
    """Say what a word of the answers means, in one sentence."""
    from hjcamp.campaign.console import make_console
    from hjcamp.commands._error_words import print_wrapped
    from hjcamp.report.glossary import ALSO, WORDS, plain_word

    asked = " ".join(word or [])
    console = make_console()
    if not asked:
        for name, said in WORDS.items():
            print_wrapped(console, [f"{name}: {said}"], 2)
        return
    found = plain_word(asked)
    if found not in WORDS:
        raise unknown("word", asked, {*WORDS, *ALSO})
    print_wrapped(console, [f"{found}: {WORDS[found]}"], 2)
