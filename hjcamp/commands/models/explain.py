"""Say what a word of the answers means (noise floor, surrogate data, ...), and what one of a plant's file takes (path, State, ...)."""

from __future__ import annotations

from typing import Annotated

import typer

from hjcamp.commands.shared.session import AnswerFile, check_answer_file, write_answer
from hjcamp.errors import UsageError, unknown


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("explain")(explain)


def explain(
    word: Annotated[
        list[str] | None,
        typer.Argument(
            help="A word, such as 'noise floor', 'posterior weight' or path; none for all of the answers.", show_default=False
        ),
    ] = None,
    json: AnswerFile = None,
) -> None:
    """Say what a word of the answers means, in one sentence, or what one of a plant's file takes: path, contact, State."""
    from hjcamp.campaign.execution.console import make_console
    from hjcamp.commands.shared.wrapped import print_wrapped
    from hjcamp.effects import effect_files
    from hjcamp.report.wording.glossary import ALSO, WORDS, plain_word

    check_answer_file(json)
    asked = " ".join(word or [])
    found = plain_word(asked)
    if asked and found not in WORDS and (name := asked.replace(" ", "_")) in effect_files():
        raise UsageError(f"'{name}' is an effect, no word of the answers: hjcamp effects {name}")
    told = {found: WORDS[found]} if found in WORDS else dict(WORDS)
    if asked and found not in WORDS:
        files = _of_files()
        if asked.lower() not in files:
            raise unknown("word", asked, {*WORDS, *ALSO, *files})
        told = dict([files[asked.lower()]])
    write_answer(json, {"schema": "hjcamp.words/1", "words": told})
    console = make_console()
    for name, said in told.items():
        print_wrapped(console, [f"{name}: {said}"], 2)


def _of_files() -> dict[str, tuple[str, str]]:
    """Return what a plant's file is written with, by its name in small letters: the name, what it takes, and what it is."""
    from inspect import Parameter, getdoc, signature

    import hjcamp.plant as words

    ours = {name: getattr(words, name) for name in words.__all__}
    found = {}
    for name, one in ours.items():
        if getattr(one, "__module__", "").startswith("hjcamp.") and name != "Plant":
            takes = [str(item.replace(annotation=Parameter.empty)) for item in signature(one).parameters.values()]
            found[name.lower()] = name, f"{name}({', '.join(takes)})  {' '.join((getdoc(one) or '').split())}"
    return found
