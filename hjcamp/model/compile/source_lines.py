"""From a fault in the composed equations back to the line of the plant's or the effect's file that it is in."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.model.compile.compose import Composition, term_functions
from hjcamp.model.compile.function_sources import rates_source
from hjcamp.model.declare.part import whole_definition

KINDS = {
    ValueError: "a function outside its range (sqrt or log of a negative number, asin beyond 1)",
    ZeroDivisionError: "a division by zero",
    OverflowError: "a number too large",
}


def outside_range(composition: Composition, fault: ArithmeticError | ValueError) -> UsageError:
    """Return the refusal of equations that fail at states of either sign: file, line, its text and what to do."""
    told = next((text for kind, text in KINDS.items() if isinstance(fault, kind)), str(fault))
    file, line, text = _place(composition, fault.__traceback__)
    owner = f"{file}, line {line}: '{text}' is " if line else f"plant {composition.plant.name}: its equations hold "
    return UsageError(
        f"{owner}{told}; states take either sign while the equations are looked at, so hold the argument within its "
        "range, such as sqrt(max(x, 0.0))"
    )


def _place(composition: Composition, trace: TracebackType | None) -> tuple[str, int, str]:
    """Return file, line and text of the innermost place in the composed equations; line 0 where it is not known."""
    names: list[tuple[str, int]] = []
    while trace is not None:
        code = trace.tb_frame.f_code
        if code.co_filename == "<composition>":
            names.append((code.co_name, trace.tb_lineno - code.co_firstlineno))
        trace = trace.tb_next
    functions = term_functions(composition.effects)
    for name, offset in reversed(names):
        if name in functions:
            return _line_of(functions[name], offset)
    if names:
        line = rates_source(composition).splitlines()[names[-1][1]]
        return _line_of_plant(composition, line.strip())
    return "", 0, ""


def _line_of(function: Callable[..., Any], offset: int) -> tuple[str, int, str]:
    """Return the place in its file of a line of a function as it was copied, ``offset`` lines below its one decorator."""
    text, first = inspect.getsourcelines(function)
    tree = _bare(ast.Module([whole_definition(function)], []))
    copied = ast.parse(ast.unparse(tree))
    # both trees have the same nodes in the same order, only their lines differ
    similar = zip(ast.walk(tree), ast.walk(copied), strict=True)
    lines = [one.lineno for one, other in similar if isinstance(one, ast.stmt) and _at(other) == offset]
    number = lines[-1] if lines else 1
    return _file(function), first + number - 1, text[number - 1].strip()


def _line_of_plant(composition: Composition, line: str) -> tuple[str, int, str]:
    """Return the place of a line of the composed equations in the plant's file."""
    equations: Callable[..., Any] = getattr(composition.plant, "equations")  # noqa: B009 - each plant brings its own
    file = _file(equations)
    target = line.partition(" = ")[0]
    if target.startswith("f["):
        target = f"d_{list(composition.states)[int(target[2:-1])]}"
    for one in composition.vocabulary.statements:
        if target == (f"d_{one.target}" if one.mark == "rate" else one.target):
            text, first = inspect.getsourcelines(equations)
            return file, one.line, text[one.line - first].strip()
    return file, 0, ""


def _bare(tree: ast.Module) -> ast.Module:
    """Return the tree of a function as it is copied into a kernel: no decorators, no annotations."""
    definition = tree.body[0]
    assert isinstance(definition, ast.FunctionDef)
    definition.decorator_list, definition.returns = [], None
    for argument in definition.args.args:
        argument.annotation = None
    return tree


def _at(node: ast.AST) -> int:
    return getattr(node, "lineno", 0)


def _file(function: Callable[..., Any]) -> str:
    path = Path(inspect.getsourcefile(function) or "?")
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)
