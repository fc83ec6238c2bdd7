"""Write the template of a user's own file, an effect or a plant: the rules for its name."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable
from pathlib import Path

from hjcamp.errors import UsageError
from hjcamp.storage import check_place, whole_file

VERBS = ("new", "test")


def write_user_file(kind: str, name: str, folder: Path, text: str, taken: Iterable[str], example: str) -> Path:
    """Write ``text`` as ``folder``/``name``.py and return its path; refuse a bad or taken name, and a file that exists."""
    check_user_name(kind, name, example)
    path = folder / f"{name}.py"
    check_place(path)
    if path.exists():
        raise UsageError(f"{path} exists; it is left as it is")
    if name in taken or name in VERBS:
        raise UsageError(f"{kind} name '{name}' is taken; choose another")
    with whole_file(path) as stream:
        stream.write(text.encode())
    return path


def check_user_name(kind: str, name: str, example: str) -> None:
    """Raise ``UsageError`` for a name that cannot be one in Python and in configuration."""
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise UsageError(f"{kind} name '{name}': write it in small letters, digits and _, such as {example}")
    if keyword.iskeyword(name) or keyword.iskeyword(class_name(name)):
        raise UsageError(f"{kind} name '{name}': this is a word of Python; choose another, such as {name}_1")


def class_name(name: str) -> str:
    """Return the name of the class in the file ``name``.py."""
    return "".join(part.capitalize() for part in name.split("_"))
