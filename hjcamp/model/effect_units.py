"""Check the units of an effect: every function is called with amounts that carry their dimension."""

from __future__ import annotations

import ast
import inspect
import math
import random
import textwrap
from collections.abc import Callable, Mapping
from typing import Any

from hjcamp.errors import UsageError
from hjcamp.model.amount import Amount, dimension, pure, text
from hjcamp.model.compose import MATHEMATICS, check_effect
from hjcamp.model.effect import Effect
from hjcamp.model.plant import Plant
from hjcamp.model.vocabulary import read_vocabulary

DRAWS = 12
SAME = ("copysign", "fmod")


def check_units(effect: type[Effect], plant: type[Plant]) -> None:
    """Refuse an effect whose functions do not give the unit of their slot or state, or that mixes units on the way.

    A number in a sum or comparison takes the unit of the other side; in a product it is a pure number, except
    9.81 (m/s^2) and 101325 (Pa).
    """
    check_effect(effect, plant)
    where = f"effect {effect.name or effect.__name__}"
    units = _units(effect, plant, where)
    slots = read_vocabulary(plant).slots
    expected = [(name, function, slots[name].unit, "the slot is in") for name, function in effect.terms.items()]
    groups = (("d_", effect.rates, "/s"), ("next_", effect.updates, ""), ("start_", effect.starts, ""))
    for prefix, group, suffix in groups:
        for state, function in group.items():
            unit = effect.states[state].unit
            whole = f"({unit}){suffix}" if unit != "1" else f"1{suffix}"
            expected.append((f"{prefix}{state}", function, whole, "it must be in"))
    for name, function, unit, said in expected:
        _check_function(function, unit, units, f"{where}, method '{name}'", said)


def _units(effect: type[Effect], plant: type[Plant], where: str) -> dict[str, str]:
    units = {name: line.unit for name, line in read_vocabulary(plant).signals.items()}
    groups: tuple[Mapping[str, Any], ...] = (plant.inputs, plant.parameters, plant.states)
    for group in groups:
        units.update({name: item.unit for name, item in group.items() if name not in units})
    own: dict[str, Any] = {**effect.parameters, **effect.states}
    for name, item in own.items():
        try:
            dimension(item.unit)
        except UsageError as problem:
            raise UsageError(f"{where}: '{name}': {problem}") from None
        units[name] = item.unit
    return units


def _check_function(function: Callable[..., float], unit: str, units: dict[str, str], where: str, said: str) -> None:
    names = list(inspect.signature(function).parameters)
    callable_ = _with_amounts(function)
    generator = random.Random(1)
    for _ in range(DRAWS):
        given = [
            Amount(generator.uniform(0.1, 2.0) * generator.choice((-1, 1)), dimension(units[name])) for name in names
        ]
        try:
            result = Amount.of(callable_(*given))
        except UsageError as problem:
            raise UsageError(f"{where}: {problem}") from None
        except (ArithmeticError, ValueError):
            continue
        # A bare 0.0 fits every slot.
        if result.dims != dimension(unit) and not (result.literal and result.value == 0.0):
            raise UsageError(f"{where} gives {text(result.dims)}, but {said} {unit} = {text(dimension(unit))}")


class _Numbers(ast.NodeTransformer):
    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if isinstance(node.value, int | float) and not isinstance(node.value, bool):
            return ast.copy_location(ast.Call(ast.Name("amount_of", ast.Load()), [node], []), node)
        return node


def _with_amounts(function: Callable[..., float]) -> Callable[..., Any]:
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    definition = tree.body[0]
    assert isinstance(definition, ast.FunctionDef)
    definition.decorator_list, definition.returns = [], None
    for argument in definition.args.args:
        argument.annotation = None
    tree = ast.fix_missing_locations(_Numbers().visit(tree))
    scope: dict[str, Any] = {name: _mathematics(name) for name in MATHEMATICS}
    scope.update(
        {"amount_of": Amount.of, "min": _smallest, "max": _largest, "abs": abs, "float": Amount.of, "int": Amount.of}
    )
    exec(compile(tree, "<units>", "exec"), scope)
    return scope[definition.name]


def _mathematics(name: str) -> Any:
    value = getattr(math, name)
    if not callable(value):
        return Amount(value, dimension("1"))

    def call(*arguments: Any) -> Amount:
        first = Amount.of(arguments[0])
        if name == "sqrt":
            return first**0.5
        if name == "pow":
            return first ** arguments[1]
        if name in ("hypot", "atan2", *SAME):
            second = arguments[1] if name == "copysign" else first.alike(arguments[1], f"{name} of")
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
