"""The commands: one file each. A file ``NAME.py`` with ``register(app)``, in a folder of ``GROUPS`` or in the folder ``commands``
of a plant that comes along, is the command ``hjcamp NAME``.

The first line of its docstring is its line in ``hjcamp --help``; the file itself is imported only when it is called.
A trailing underscore is not part of the name (``import_.py``).
"""

from __future__ import annotations

import ast
import importlib
import os
import tokenize
from functools import cache
from pathlib import Path
from typing import Any

import typer
import typer.main
from typer.core import TyperCommand, TyperGroup

from hjcamp.errors import unknown

PACKAGE = Path(__file__).parents[1]
#: The folders here that hold commands; the others hold what commands share.
GROUPS = ("campaigns", "diagnosing", "logs", "models", "runs", "setup")
FOLDERS = (*(PACKAGE / "commands" / group for group in GROUPS), *sorted(PACKAGE.glob("plants/*/commands")))
#: A shell that asks for completions sets it.
COMPLETING = "_HJCAMP_COMPLETE"


# Boxes around a help text would take longer to import than all else that it needs.
PLAIN: dict[str, Any] = {
    "pretty_exceptions_enable": False,
    "rich_markup_mode": None,
    "context_settings": {"max_content_width": 110},
}


@cache
def command_files() -> dict[str, Path]:
    """Return the name and file of every command."""
    files = [path for folder in FOLDERS for path in folder.glob("*.py") if not path.name.startswith("_")]
    return {path.stem.rstrip("_"): path for path in sorted(files, key=lambda path: path.name)}


def one_line(path: Path) -> str:
    """Return the first line of a file's docstring without importing the file."""
    with tokenize.open(path) as stream:
        # The docstring is the first token that is text; the rest of the file is not read.
        for word in tokenize.generate_tokens(stream.readline):
            if word.type == tokenize.STRING:
                return str(ast.literal_eval(word.string)).partition("\n")[0]
    return ""


class Commands(TyperGroup):
    """A group whose commands are files, imported when they are called."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all commands."""
        return list(command_files())

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a stand-in with the command's one line, for help and completion; nothing is imported."""
        path = command_files().get(cmd_name)
        if path is None:
            return None
        line = one_line(path)
        return TyperCommand(cmd_name, short_help=line, help=line)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that the arguments name; an unknown one is refused with the nearest match."""
        files = command_files()
        if args[0] not in files:
            if ctx.resilient_parsing:
                return None, None, args
            raise unknown("command", args[0], files)
        return args[0], load(files[args[0]]), args[1:]


def load(path: Path) -> Any:
    """Import a command's file and return its command."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    module = importlib.import_module(".".join((PACKAGE.name, *parts)))
    app = typer.Typer(**PLAIN)
    module.register(app)
    if COMPLETING in os.environ:
        importlib.import_module(f"{__name__}.shared.complete").add_completions(app)
    return typer.main.get_group(app).commands[path.stem.rstrip("_")]
