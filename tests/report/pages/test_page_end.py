"""The end of every page: the command that made it, and logs that are the same whatever their order."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from hjcamp.commands.shared.page_end import CALL, made_from, next_steps


def logs(folder: Path) -> list[Any]:
    found = []
    for name in ("a", "b"):
        (folder / name).write_text(name)
        found.append(SimpleNamespace(path=folder / name))
    return found


def test_a_page_says_what_made_it_of_which_logs(tmp_path: Path) -> None:
    some = logs(tmp_path)
    assert "called from Python" in made_from(some)
    token = CALL.set(("compare", "my logs", "--model", "<b>"))
    try:
        said = made_from(some)
    finally:
        CALL.reset(token)
    assert "hjcamp compare &#x27;my logs&#x27; --model &#x27;&lt;b&gt;&#x27;" in said and "2 logs, sha256 " in said
    hashed = said.split("sha256 ")[1][:12]
    assert hashed in made_from(some[::-1]) and hashed not in made_from(some[:1])


def test_the_commands_that_go_on_can_be_pasted() -> None:
    assert next_steps([]) == "" and "<pre>hjcamp add a &amp;\nhjcamp next</pre>" in next_steps(
        ["hjcamp add a &", "hjcamp next"]
    )
