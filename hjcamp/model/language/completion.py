"""What a plant's elements are not given and its equations say: the mass of a contact, where a body stands, or what is driven."""

from __future__ import annotations

import ast

from hjcamp.model.declare.element import BODY, ELEMENTS, TRANSMISSION, bare_name, called


def masses_in(function: ast.FunctionDef) -> dict[str, str]:
    """Return for each state whose rate is a body's, or a quotient, the parameter that stands for the mass."""
    found = {}
    for node in function.body:
        if not isinstance(node, ast.Assign) or not isinstance(node.targets[0], ast.Attribute):
            continue
        value, mass = node.value, None
        if isinstance(value, ast.BinOp) and isinstance(value.op, ast.Div):
            mass = value.right
        elif isinstance(value, ast.Call) and called(value) == BODY.name:
            named = {keyword.arg: keyword.value for keyword in value.keywords}
            mass = named.get("mass", value.args[1] if len(value.args) > 1 else None)
        if mass is not None and ast.unparse(mass).startswith("parameter.") and bare_name(ast.unparse(mass)):
            found[f"state.{node.targets[0].attr}"] = ast.unparse(mass)
    return found


def positions_in(function: ast.FunctionDef) -> dict[str, str]:
    """Return for each state that is the rate of one other state alone that other one: where what has this velocity stands."""
    found: dict[str, list[str]] = {}
    for node in function.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Attribute):
            found.setdefault(ast.unparse(node.value), []).append(f"state.{node.targets[0].attr}")
    return {rate: states[0] for rate, states in found.items() if len(states) == 1 and rate.startswith("state.")}


def velocity_of(call: ast.Call) -> str:
    """Return the expression of a contact's velocity; empty where it is given none."""
    given = {keyword.arg: keyword.value for keyword in call.keywords}
    velocity = given.get("velocity", call.args[0] if call.args else None)
    return "" if velocity is None else ast.unparse(velocity)


def has_push(node: ast.AST) -> bool:
    """Whether the call of a contact is given its push."""
    return isinstance(node, ast.Call) and (len(node.args) > 1 or any(one.arg == "push" for one in node.keywords))


def completed(call: ast.Call, name: str, value: str | None) -> ast.Call:
    """Return the call of an element with an argument that it is not given."""
    element = ELEMENTS[called(call)]
    if value is None or name in {keyword.arg for keyword in call.keywords} or len(call.args) > element.arguments.index(name):
        return call
    return ast.Call(call.func, call.args, [*call.keywords, ast.keyword(name, ast.parse(value, mode="eval").body)])


def driven_in(function: ast.FunctionDef) -> dict[str, str]:
    """Return for each transmission from which a line takes a state, or a parameter times a state, that which it takes.

    What passes on the difference of two states, a twist, drives nothing where that is 0.
    """
    lines = [node for node in function.body if isinstance(node, ast.Assign)]
    passed = {ast.unparse(node.targets[0]): node.value for node in lines if called(node.value) == TRANSMISSION.name}
    found: dict[str, set[str]] = {}
    for name, call in passed.items():
        given = call.args[0] if isinstance(call, ast.Call) and call.args else None
        if (
            isinstance(given, ast.BinOp)
            and isinstance(given.op, ast.Sub)
            and _of_a_state(given.left)
            and _of_a_state(given.right)
        ):
            found[name] = {f"0.0 * ({ast.unparse(given.right)})"}
    for node in ast.walk(function):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub):
            for one, other in ((node.left, node.right), (node.right, node.left)):
                if isinstance(one, ast.Name) and one.id in passed and _of_a_state(other):
                    found.setdefault(one.id, set()).add(ast.unparse(other))
    return {name: next(iter(texts)) for name, texts in found.items() if len(texts) == 1}


def _of_a_state(node: ast.AST) -> bool:
    """Whether an expression is one state, times or over parameters."""
    allowed = (ast.BinOp, ast.Mult, ast.Div, ast.Attribute, ast.Name, ast.Constant, ast.Load)
    spaces = [one.id for one in ast.walk(node) if isinstance(one, ast.Name)]
    plain = all(isinstance(one, allowed) for one in ast.walk(node)) and {*spaces} <= {"state", "parameter"}
    return plain and spaces.count("state") == 1
