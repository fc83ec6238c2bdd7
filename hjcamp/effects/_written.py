"""What an effect file that is begun from an answer may hold: such a file runs, and the answer may be anybody's."""

from __future__ import annotations

import ast
import keyword
import re
from collections.abc import Iterable
from pathlib import Path

from hjcamp.effects._begun import Begun
from hjcamp.effects._forms import CALLED
from hjcamp.errors import UsageError, shown
from hjcamp.model.language.amount import dimension

LONGEST_TEXT = 200
FACTOR = r"(?:1|[A-Za-z]{1,12}(?:\^-?\d(?:\.\d)?)?)"
UNIT = re.compile(rf"{FACTOR}(?:[*/ ]\(?{FACTOR}\)?){{0,8}}")
WORDS = re.compile(r"[\w ,.()+\-]*")
IMPORTS = (
    ("__future__", {"annotations"}),
    ("hjcamp.effect", {"Effect", "Parameter", "State"}),
    ("math", set(CALLED)),
)
FORMULA = (
    ast.Name, ast.Load, ast.Constant, ast.BinOp, ast.Add, ast.Sub, ast.Mult, ast.Div, ast.UnaryOp, ast.USub,
    ast.IfExp, ast.Compare, ast.Lt,
)  # fmt: skip


def check_begun(begun: Begun) -> None:
    """Raise ``UsageError`` for a text that is no plain word, a unit that is none, and a name that is no name."""
    for unit in (begun.unit, *(one.unit for one in begun.tables)):
        if not isinstance(unit, str) or not UNIT.fullmatch(unit):
            raise UsageError(f"unknown unit {shown(unit)}; write SI units, such as m, rad, N, Pa*s/m^3, 1")
        dimension(unit)
    for text in (begun.driver, begun.subsystem, begun.plant, *(one.text for one in begun.tables)):
        if len(text) > LONGEST_TEXT or not WORDS.fullmatch(text):
            raise UsageError(f"{shown(text)} is no plain text: letters, digits, spaces and , . ( ) + - are allowed")
    slots = [slot for one in begun.tables for slot in (*one.slots, *one.against)]
    for name in (*begun.arguments, *slots, *(one.amplitude for one in begun.tables)):
        if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
            raise UsageError(f"{shown(name)} is no name of a plant")


def plain_origin(path: Path) -> str:
    """Return a path as a comment may hold it."""
    return re.sub(r"[^\w ./-]", "_", path.as_posix())[-LONGEST_TEXT:]


def check_effect_file(text: str) -> None:
    """Raise ``UsageError`` unless a text is one effect: declarations of constants, and methods that are formulas of numbers."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as problem:
        raise UsageError(f"what is written would be no Python: {problem}") from None
    *imports, last = [one for one in tree.body if not _is_text(one)]
    whole = all(map(_is_import, imports)) and isinstance(last, ast.ClassDef) and not (last.keywords or last.decorator_list)
    if not whole or not all(map(_is_member, last.body)) or [ast.unparse(one) for one in last.bases] != ["Effect"]:  # type: ignore[attr-defined]
        raise UsageError("what is written would be more than an effect: the answer holds what is no name, unit or number")


def _is_text(one: ast.stmt) -> bool:
    return isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant)


def _is_import(one: ast.stmt) -> bool:
    return isinstance(one, ast.ImportFrom) and any(
        one.module == module and {name.name for name in one.names} <= names and not any(name.asname for name in one.names)
        for module, names in IMPORTS
    )


def _is_member(one: ast.stmt) -> bool:
    if isinstance(one, ast.FunctionDef):
        names = not (one.args.defaults or one.args.kw_defaults or one.returns or any(each.annotation for each in one.args.args))
        plain = names and all(map(_is_line, one.body))
        return plain and [ast.unparse(each) for each in one.decorator_list] == ["staticmethod"]
    if isinstance(one, ast.Assign) and isinstance(one.targets[0], ast.Name):
        return _is_constant(one.value) or _is_call(one.value, ("Parameter", "State"))
    return _is_text(one)


def _is_line(one: ast.stmt) -> bool:
    if isinstance(one, ast.Assign) and not all(isinstance(target, ast.Name) for target in one.targets):
        return False
    return _is_text(one) or (isinstance(one, ast.Assign | ast.Return) and one.value is not None and _is_formula(one.value))


def _is_formula(value: ast.expr) -> bool:
    calls = [node for node in ast.walk(value) if isinstance(node, ast.Call)]
    named = all(
        isinstance(call.func, ast.Name) and call.func.id in ("abs", "min", "max", *CALLED) and not call.keywords
        for call in calls
    )
    return named and all(isinstance(node, (ast.Call, *FORMULA)) for node in ast.walk(value))


def _is_call(value: ast.expr, names: Iterable[str]) -> bool:
    if not isinstance(value, ast.Call) or not isinstance(value.func, ast.Name) or value.func.id not in names:
        return False
    parts = [*value.args, *(one.value for one in value.keywords)]
    return all(map(_is_constant, [each for one in parts for each in (one.elts if isinstance(one, ast.Tuple) else [one])]))


def _is_constant(value: ast.expr) -> bool:
    return isinstance(value.operand if isinstance(value, ast.UnaryOp) else value, ast.Constant)
