"""Read a plant's marked equations: the one vocabulary of slots, signals, states, inputs and parameters."""

from __future__ import annotations

import ast
import inspect
import textwrap
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from hjcamp.errors import HjcampError
from hjcamp.model.plant import Plant

NAMESPACES = {"state": "s_", "parameter": "p_", "drive": "u_", "rate": "d_"}


@dataclass(frozen=True)
class Statement:
    """One line of the equations: ``target`` = ``expression``; ``mark`` is "slot", "signal", "rate" or "plain"."""

    target: str
    expression: str
    mark: str
    unit: str = ""
    text: str = ""


@dataclass(frozen=True)
class Vocabulary:
    """What a plant offers to effects: its statements in order, and the names each place may use."""

    plant: type[Plant]
    statements: tuple[Statement, ...]
    readings: tuple[str, ...]
    limits: tuple[tuple[str, str, str], ...]

    @cached_property
    def slots(self) -> dict[str, Statement]:
        """Every slot by name, in order of computation."""
        return {line.target: line for line in self.statements if line.mark == "slot"}

    @cached_property
    def signals(self) -> dict[str, Statement]:
        """Every signal and slot by name, in order of computation."""
        return {line.target: line for line in self.statements if line.mark in ("slot", "signal")}

    def known_before(self, name: str) -> list[str]:
        """Return the signals that are computed before the slot ``name``."""
        names = list(self.signals)
        return names[: names.index(name)] if name in names else names


class _Rename(ast.NodeTransformer):
    """Turn ``state.x`` into the local name ``s_x`` (and so on), and number every ``limited(...)``: its power of 3."""

    def __init__(self) -> None:
        self.limits: list[tuple[str, str, str]] = []

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if isinstance(node.value, ast.Name) and node.value.id in NAMESPACES:
            return ast.copy_location(ast.Name(NAMESPACES[node.value.id] + node.attr, node.ctx), node)
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        node = ast.Call(node.func, [self.visit(argument) for argument in node.args], node.keywords)
        if isinstance(node.func, ast.Name) and node.func.id == "limited":
            value, low, high = (ast.unparse(argument) for argument in node.args)
            node.args.append(ast.Constant(3 ** len(self.limits)))
            self.limits.append((value, low, high))
        return node


def read_vocabulary(plant: type[Plant]) -> Vocabulary:
    """Parse ``plant.equations`` into statements; the docstring and comments are skipped."""
    hashable: Any = plant
    return _parsed(hashable)


@cache
def _parsed(plant: Any) -> Vocabulary:
    tree = ast.parse(textwrap.dedent(inspect.getsource(plant.equations)))
    function = tree.body[0]
    assert isinstance(function, ast.FunctionDef)
    rename = _Rename()
    statements: list[Statement] = []
    readings: tuple[str, ...] = ()
    for node in function.body:
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            continue
        if isinstance(node, ast.Return):
            assert isinstance(node.value, ast.Tuple)
            readings = tuple(ast.unparse(element) for element in node.value.elts)
            continue
        if not isinstance(node, ast.Assign):
            raise HjcampError(f"plant {plant.name}: equations may hold assignments only, not line {node.lineno}")
        statements.append(_statement(node, rename))
    return Vocabulary(plant, tuple(statements), readings, tuple(rename.limits))


def _statement(node: ast.Assign, rename: _Rename) -> Statement:
    target = node.targets[0]
    value = node.value
    if isinstance(target, ast.Attribute):
        return Statement(target.attr, ast.unparse(rename.visit(value)), "rate")
    assert isinstance(target, ast.Name)
    if isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id in ("slot", "signal"):
        expression = ast.unparse(rename.visit(value.args[0]))
        unit, text = (ast.literal_eval(argument) for argument in value.args[1:3])
        return Statement(target.id, expression, value.func.id, unit, text)
    return Statement(target.id, ast.unparse(rename.visit(value)), "plain")
