"""What writing out a part does with its lines: names of their own, values for its arguments, members by their names."""

from __future__ import annotations

import ast
import copy
import re

from hjcamp.errors import UsageError, unknown

# Spaces whose members a part may name by an argument: rate[position], memory[integral].
SPACES = ("state", "parameter", "drive", "rate", "memory", "sample")
# What these hold belongs to one part alone.
OWNED = ("rate", "memory")


class Change(ast.NodeTransformer):
    """Gives the lines of a part their names and its arguments their values."""

    def __init__(self, names: dict[str, str], given: dict[str, ast.expr]) -> None:
        self.names, self.given = names, given

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if node.id in self.given:
            return copy.deepcopy(self.given[node.id])
        return ast.Name(self.names.get(node.id, node.id), node.ctx)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        changed = self.generic_visit(node)
        assert isinstance(changed, ast.Subscript)
        space, member = changed.value, changed.slice
        if isinstance(space, ast.Name) and space.id in SPACES:
            name = member.value if isinstance(member, ast.Constant) else getattr(member, "attr", None)
            if isinstance(name, str):
                return ast.Attribute(space, name, changed.ctx)
        return changed


def computed(given: dict[str, ast.expr], prefix: str) -> tuple[list[ast.stmt], dict[str, ast.expr]]:
    """Return the lines that compute arguments once, and what stands for each: itself where it is a name or a constant."""
    lines: list[ast.stmt] = []
    replaced = {}
    for name, value in given.items():
        member = isinstance(value, ast.Attribute) and isinstance(value.value, ast.Name) and value.value.id != "memory"
        if member or isinstance(value, ast.Name | ast.Constant):
            replaced[name] = value
        else:
            lines.append(ast.Assign([ast.Name(prefix + name, ast.Store())], value))
            replaced[name] = ast.Name(prefix + name, ast.Load())
    return lines, replaced


def given_to(definition: ast.FunctionDef, call: ast.Call, label: str) -> dict[str, ast.expr]:
    """Return the value of every argument of a part."""
    arguments = [argument.arg for argument in definition.args.args]
    values = call.args[1:]
    further = (definition.args.vararg, definition.args.kwarg, *definition.args.kwonlyargs, *definition.args.posonlyargs)
    if any(further) or any(isinstance(value, ast.Starred) for value in values) or any(not one.arg for one in call.keywords):
        raise UsageError(f"{label}: it takes its arguments one by one, each by its name or place (no *, no **)")
    if len(values) > len(arguments):
        raise UsageError(f"{label} takes {len(arguments)} arguments: {', '.join(arguments)}")
    found = dict(zip(arguments, values, strict=False))
    for keyword in call.keywords:
        if keyword.arg not in arguments:
            raise unknown("argument", str(keyword.arg), arguments, label)
        if keyword.arg in found:
            raise UsageError(f"{label} gets '{keyword.arg}' twice")
        found[keyword.arg] = keyword.value
    defaults = definition.args.defaults
    for name, value in zip(arguments[len(arguments) - len(defaults) :], defaults, strict=True):
        found.setdefault(name, value)
    if lacks := [name for name in arguments if name not in found]:
        raise UsageError(f"{label} lacks '{lacks[0]}'; it takes {', '.join(arguments)}")
    return found


def is_part(node: ast.AST | None) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "part"


def is_text(line: ast.stmt) -> bool:
    return isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant)


def targets_of(line: ast.stmt) -> list[ast.expr]:
    return elements(line.targets[0]) if isinstance(line, ast.Assign) else []


def elements(node: ast.expr) -> list[ast.expr]:
    return list(node.elts) if isinstance(node, ast.Tuple) else [node]


def called_like(target: ast.expr) -> str:
    return target.attr if isinstance(target, ast.Attribute) else re.sub(r"\W+", "_", ast.unparse(target)).strip("_")


def names_in_tree(tree: ast.AST) -> set[str]:
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


def stored(tree: ast.AST) -> set[str]:
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}


def fixed(tree: ast.AST) -> set[str]:
    """Return what a line sets by a fixed name: ``rate.x``, ``memory.x`` and ``memory.x[...]``."""
    found = set()
    for node in ast.walk(tree):
        stored = isinstance(getattr(node, "ctx", None), ast.Store)
        one = node.value if isinstance(node, ast.Subscript) else node
        if stored and isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name) and one.value.id in OWNED:
            found.add(f"{one.value.id}.{one.attr}")
    return found
