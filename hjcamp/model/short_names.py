"""Equations as people shorten them: ``p = parameter``, arguments called otherwise, and several names on one line."""

from __future__ import annotations

import ast
from collections.abc import Collection, Sequence


def written_out(function: ast.FunctionDef, spaces: Sequence[str]) -> ast.FunctionDef:
    """Return equations with one name a line, and what stands for one of ``spaces`` (the arguments, in order) written as that.

    A line that swaps names stays as it is.
    """
    given = [one.arg for one in function.args.args]
    renamed = dict(zip(given, spaces, strict=False)) if len(given) == len(spaces) and not set(given) & set(spaces) else {}
    function.body = [line for statement in function.body for line in _one_each(statement)]
    short = {
        line.targets[0].id: line.value.id
        for line in function.body
        if isinstance(line, ast.Assign) and isinstance(line.targets[0], ast.Name)
        and isinstance(line.value, ast.Name) and line.value.id in {*spaces, *renamed}
    }  # fmt: skip
    short = renamed | {name: renamed.get(one, one) for name, one in short.items()}
    if short:
        function.body = [line for line in function.body if not _is_short(line, short)]
        for node in ast.walk(function):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                node.value.id = short.get(node.value.id, node.value.id)
    return function


def _one_each(line: ast.stmt) -> list[ast.stmt]:
    """Return the lines of an assignment of several names, one for each."""
    if not isinstance(line, ast.Assign) or len(line.targets) != 1:
        return [line]
    target, value = line.targets[0], line.value
    if not isinstance(target, ast.Tuple) or not isinstance(value, ast.Tuple) or len(target.elts) != len(value.elts):
        return [line]
    set_here = {ast.unparse(one) for one in target.elts}
    if any(isinstance(node, ast.expr) and ast.unparse(node) in set_here for node in ast.walk(value)):
        return [line]
    return [
        ast.copy_location(ast.Assign([one], given), line) for one, given in zip(target.elts, value.elts, strict=True)
    ]


def _is_short(line: ast.stmt, short: Collection[str]) -> bool:
    return isinstance(line, ast.Assign) and isinstance(line.targets[0], ast.Name) and line.targets[0].id in short
