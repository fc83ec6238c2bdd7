"""Evaluate formulas with amounts: every function of a term or a line of a plant on numbers that carry their dimension."""

from __future__ import annotations

import ast
import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from hjcamp.model.declare.part import whole_definition
from hjcamp.model.language.amount import Amount, dimension, pure

MATHEMATICS = [
    "acos", "asin", "atan", "atan2", "ceil", "copysign", "cos", "cosh", "erf", "exp", "expm1", "floor", "fmod",
    "hypot", "log", "log10", "log1p", "pi", "pow", "sin", "sinh", "sqrt", "tan", "tanh",
]  # fmt: skip
SAME = ("copysign", "fmod")


class _Numbers(ast.NodeTransformer):
    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if isinstance(node.value, int | float) and not isinstance(node.value, bool):
            return ast.copy_location(ast.Call(ast.Name("amount_of", ast.Load()), [node], []), node)
        return node


@functools.cache
def with_amounts(function: Callable[..., float]) -> Callable[..., Any]:
    """Return ``function`` for amounts: each of its numbers is one."""
    definition = whole_definition(function)
    definition.decorator_list, definition.returns = [], None
    for argument in definition.args.args:
        argument.annotation = None
    tree = ast.Module([_Numbers().visit(definition)], [])
    scope = names()
    exec(compile(ast.fix_missing_locations(tree), "<units>", "exec"), scope)
    made: Callable[..., Any] = scope[definition.name]
    return made


def names() -> dict[str, Any]:
    """Return the functions and constants that a formula may use, for amounts."""
    scope: dict[str, Any] = {name: _mathematics(name) for name in MATHEMATICS}
    scope.update(amount_of=Amount.of, min=_smallest, max=_largest, abs=abs, float=Amount.of, int=Amount.of)
    scope["limited"] = lambda value, low, high, place=0: _largest(_smallest(value, high), low)
    return scope


def evaluated(expression: str, scope: dict[str, Any]) -> Amount:
    """Return the amount of an expression, the names in it taken from ``scope`` (see ``names``)."""
    tree = ast.fix_missing_locations(_Numbers().visit(ast.parse(expression, mode="eval")))
    return Amount.of(eval(compile(tree, "<units>", "eval"), scope))


def plain_functions(source: str) -> dict[str, Any]:
    """Return what generated source defines, as plain Python."""
    scope: dict[str, Any] = {name: getattr(math, name) for name in MATHEMATICS}
    scope.update(dict.fromkeys(("entry", "hot", "inlined", "once"), lambda function: function), np=np)
    scope["limited"] = lambda value, low, high, place=0: min(max(value, low), high)
    scope["bounded"] = lambda limits, value, low, high, place=0: min(max(value, low), high)
    exec(compile(source, "<composition>", "exec"), scope)
    return scope


def _mathematics(name: str) -> Any:
    value = getattr(math, name)
    if not callable(value):
        return Amount(value, dimension("1"))

    def call(*arguments: Any) -> Amount:
        first = Amount.of(arguments[0])
        if name == "sqrt":
            return first**0.5
        if name == "pow":
            power: Amount = first ** arguments[1]
            return power
        if name in ("hypot", "atan2", *SAME):
            second = arguments[1] if name == "copysign" else first.in_same_unit(arguments[1], f"{name} of")
            dims = dimension("1") if name == "atan2" else first.dims
            return Amount(value(first.value, Amount.of(second).value), dims)
        return Amount(value(*(pure(argument, f"the argument of {name}") for argument in arguments)), dimension("1"))

    return call


def _chosen(arguments: tuple[Any, ...], pick: Callable[..., float]) -> Amount:
    total = Amount.of(arguments[0])
    for other in arguments[1:]:
        total = total + other
    return Amount(pick(Amount.of(argument).value for argument in arguments), total.dims, total.literal)


def _smallest(*arguments: Any) -> Amount:
    return _chosen(arguments, min)


def _largest(*arguments: Any) -> Amount:
    return _chosen(arguments, max)
