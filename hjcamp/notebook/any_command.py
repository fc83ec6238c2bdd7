"""Any command in Python: those that have no function of their own."""

from __future__ import annotations

import contextlib
import html
import io
import json
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from hjcamp.errors import HjcampError, UsageError, unknown


def command(*words: str | Path) -> str:
    """Run a command with its words as they would be typed, and return what it prints: `next`, `tune`, `budget`, `sizing` ...

    Raises what the command reports, ``UsageError`` for an unknown command or option. With ``--json -`` the answer is printed.

    >>> "stage" in hjcamp.command("plants")
    True
    >>> hjcamp.command("siezing")
    Traceback (most recent call last):
        ...
    hjcamp.errors.UsageError: unknown command 'siezing'; did you mean 'sizing'? ...
    """
    from hjcamp.commands import command_files, load
    from hjcamp.commands.shared.session import free_standard_output

    files = command_files()
    name, *given = [str(word) for word in words] or [""]
    if name not in files:
        raise unknown("command", name, files)
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            load(files[name]).main(args=given, prog_name=f"hjcamp {name}", standalone_mode=False)
        except HjcampError:
            raise
        except Exception as error:
            # What is wrong with an option is an exception of click, whichever click typer brings.
            if not hasattr(error, "format_message"):
                raise
            raise UsageError(f"{error.format_message()}  (hjcamp {name} --help)") from None
        finally:
            free_standard_output()
    return out.getvalue()


@dataclass(frozen=True)
class Said:
    """What a command printed, and its answer for programs; None where it has none."""

    text: str
    answer: Mapping[str, Any] | None = None

    def __repr__(self) -> str:
        return self.text.rstrip()

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.text.rstrip())}</pre>"


Function: TypeAlias = Callable[..., Said]
#: Functions that are commands with their words, by name.
COMMANDS: Mapping[str, tuple[str, ...]] = {
    "budget": ("budget",), "diff": ("diff",), "explain": ("explain",), "export": ("log", "export"), "history": ("history",),
    "next": ("next",), "paper": ("paper",), "tune": ("tune",),
}  # fmt: skip


def of_command(name: str, given: Sequence[str]) -> Function:
    """Return the function that runs a command: words as they would be typed, options by their names."""

    def run(*words: str | Path, **options: object) -> Said:
        typed = [*given, *words, *_typed(options)]
        if "json" in options or not _answers(given):
            return Said(command(*typed))
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "answer.json"
            said = command(*typed, "--json", file)
            return Said(said, json.loads(file.read_text(encoding="utf-8")) if file.is_file() else None)

    run.__name__ = run.__qualname__ = name
    run.__doc__ = (
        f"Run ``hjcamp {' '.join(given)}``: words as they would be typed, options by their names (``workers=2``, ``all=True``).\n\n"
        f"Returns what it prints (``text``) and its answer for programs (``answer``); ``hjcamp {' '.join(given)} --help`` says what it "
        "takes. Raises what the command reports."
    )
    return run


def _typed(options: Mapping[str, object]) -> list[str]:
    """Return options as words: True is a flag, False and None are left out, a list is given one by one."""
    found = []
    for name, value in options.items():
        flag = f"--{name.rstrip('_').replace('_', '-')}"
        for one in value if isinstance(value, list | tuple) else [value]:
            if one is not None and one is not False:
                found += [flag] if one is True else [flag, str(one)]
    return found


def _answers(given: Sequence[str]) -> bool:
    """Return whether a command writes an answer for programs (``--json``)."""
    from hjcamp.commands import command_files, load

    found: Any = load(command_files()[given[0]])
    for word in given[1:]:
        found = found.commands[word]
    return any("--json" in one.opts for one in found.params)


FURTHER: Mapping[str, Function] = {name: of_command(name, given) for name, given in COMMANDS.items()}
