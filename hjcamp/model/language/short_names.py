"""Equations as people shorten them: ``p = parameter``, arguments called otherwise, and several names on one line."""

from __future__ import annotations

import ast
from collections.abc import Sequence


def written_out(function: ast.FunctionDef, spaces: Sequence[str]) -> ast.FunctionDef:
    """Return equations with one name a line, and what stands for one of ``spaces`` (the arguments, in order) written as that.

    A line that swaps names stays as it is.
    """
    given = [one.arg for one in function.args.args]
    stands_for = {one: one for one in spaces}
    if len(given) == len(spaces) and not set(given) & set(spaces):
        stands_for |= dict(zip(given, spaces, strict=True))
    kept = []
    for line in (one for statement in function.body for one in _one_each(statement)):
        target, value = (line.targets[0], line.value) if isinstance(line, ast.Assign) else (None, None)
        if isinstance(target, ast.Name) and isinstance(value, ast.Name) and value.id in stands_for:
            stands_for[target.id] = stands_for[value.id]
        else:
            kept.append(line)
    function.body = kept
    for node in ast.walk(function):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            node.value.id = stands_for.get(node.value.id, node.value.id)
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
    return [ast.copy_location(ast.Assign([one], given), line) for one, given in zip(target.elts, value.elts, strict=True)]
