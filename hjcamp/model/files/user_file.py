"""Read a Python file of the user's (effect, controller, trajectory): whatever is wrong is one message with file and line."""

from __future__ import annotations

import ast
import dataclasses
import hashlib
import keyword
import re
import sys
import threading
import traceback
import types
from pathlib import Path

from hjcamp.errors import HjcampError, UsageError, text_of, unknown
from hjcamp.model.files.time_limit import time_limit
from hjcamp.storage import check_is_file

PREFIX = "hjcamp_file_"
LOADING_S = 15.0
# What other libraries call a choice between two values.
CHOICES = ("where", "if_else", "select", "piecewise", "switch")
_loading = threading.RLock()


def is_users(module: str) -> bool:
    """Return whether a module of that name is a file of the user's."""
    return module.startswith(PREFIX)


def file_of(module: str) -> str:
    """Return the path of the user's file that a module of that name is; empty where it is none."""
    return str(sys.modules[module].__file__) if is_users(module) and module in sys.modules else ""


def load_module(path: Path) -> types.ModuleType:
    """Import the file at ``path`` under a name of its own; a mistake in it is one clear message."""
    check_name(path)
    content = _read(path)
    digest = hashlib.sha256(str(path.resolve()).encode() + content.encode()).hexdigest()[:12]
    name = f"{PREFIX}{path.stem}_{digest}"
    with _loading:
        if name in sys.modules:
            return sys.modules[name]
        module = types.ModuleType(name)
        module.__file__ = str(path)
        # A dataclass asks for the module of its class while that is being made.
        sys.modules[name] = module
        try:
            with time_limit(LOADING_S, f"{path}: loading this file"):
                exec(compile(content, str(path), "exec"), vars(module))
        except BaseException as problem:
            del sys.modules[name]
            if isinstance(problem, KeyboardInterrupt):
                raise
            raise UsageError(_what_is_wrong(path, problem)) from None
        return module


def check_name(path: Path) -> None:
    """Raise ``UsageError`` for a file whose name could not be written in a configuration or in Python."""
    if not path.stem.isidentifier() or not path.stem.isascii() or keyword.iskeyword(path.stem):
        why = "is a word of Python" if keyword.iskeyword(path.stem) else "cannot be a name"
        raise UsageError(
            f"{path}: '{path.stem}' {why}. Allowed: letters, digits and _, beginning with a letter, such as "
            f"{''.join(letter if letter.isascii() and letter.isalnum() else '_' for letter in path.stem).strip('_')}_1.py"
        )


def line_in(path: str, problem: BaseException) -> int | None:
    """Return the line of the file at which a problem arose."""
    lines = [frame.lineno for frame in traceback.extract_tb(problem.__traceback__) if frame.filename == path]
    return lines[-1] if lines else None


def _read(path: Path) -> str:
    try:
        check_is_file(path)
        content = path.read_bytes()
        return content.decode()
    except UnicodeDecodeError as problem:
        line = content[: problem.start].count(b"\n") + 1
        raise UsageError(f"{path}: line {line}: this is not UTF-8 text") from None
    except OSError as problem:
        raise UsageError(f"{path}: cannot be read: {problem.strerror or problem}") from None


def _what_is_wrong(path: Path, problem: BaseException) -> str:
    if isinstance(problem, SyntaxError) and problem.filename == str(path):
        return f"{path}: line {problem.lineno}: {problem.msg}"
    line = line_in(str(path), problem)
    where = f"{path}: line {line}" if line else str(path)
    # Python 3.11 wraps what a declaration (__set_name__) refuses in a RuntimeError.
    for known in (problem, problem.__cause__):
        if isinstance(known, HjcampError):
            said = str(known)
            declared = _declared_in(path, said)
            return (
                said if said.startswith(str(path)) else f"{path}: line {declared}: {said}" if declared else f"{where}: {said}"
            )
    if isinstance(problem, SystemExit):
        return f"{where}: this file ends the program ({type(problem).__name__}: {text_of(problem)}); it may only define things"
    if said := _unknown_argument(problem) or _unknown_import(problem):
        return f"{where}: {said}"
    return f"{where}: cannot be loaded: {type(problem).__name__}: {text_of(problem)}"


def _declared_in(path: Path, said: str) -> int | None:
    """Return the line of what is refused as ``CLASS.NAME: ...``: Python names that of its class, which ends before it is looked at."""
    owner, _, name = said.partition(":")[0].partition(".")
    classes = (one for one in ast.walk(ast.parse(_read(path))) if isinstance(one, ast.ClassDef) and one.name == owner)
    lines = (line for one in classes for line in one.body if isinstance(line, ast.Assign))
    return next((line.lineno for line in lines if name in map(ast.unparse, line.targets)), None)


def _unknown_argument(problem: BaseException) -> str:
    """Return what is wrong where a declaration (``State(...)``) is given an argument that it has not, else nothing."""
    found = re.match(r"(\w+)\.__init__\(\) got an unexpected keyword argument '(\w+)'", text_of(problem))
    frames = list(traceback.walk_tb(problem.__traceback__))
    kind = frames[-1][0].f_globals.get(found[1]) if found and frames else None
    if found is None or not dataclasses.is_dataclass(kind):
        return ""
    return str(unknown("argument", found[2], [one.name for one in dataclasses.fields(kind) if one.init], f"{found[1]}(...)"))


def _unknown_import(problem: BaseException) -> str:
    """Return what is wrong where a name is imported from a module of this program that it has not, else nothing."""
    found = re.match(r"cannot import name '(\w+)' from '(hjcamp[\w.]*)'", text_of(problem))
    if found is None or not isinstance(problem, ImportError):
        return ""
    offered = getattr(sys.modules[found[2]], "__all__", None) or [one for one in vars(sys.modules[found[2]]) if one[0] != "_"]
    choice = " A choice is written 'A if CONDITION else B'." if found[1] in CHOICES else ""
    return f"{unknown('name', found[1], offered, found[2])}.{choice}"
