"""What a plant's elements are not given and its equations say: the mass of a contact, where a body stands, or what is driven."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence

from hjcamp.model.declare.element import BODY, CONTACT, ELEMENTS, TRANSMISSION, bare_name, called


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


def loads_in(function: ast.FunctionDef) -> dict[str, str]:
    r"""Return for each contact without a load what passes through what it brakes, from one of the forces on that to the others.

    .. math:: L = \tfrac12 \Bigl(\sum_i |F_i| + \bigl|\sum_i F_i\bigr|\Bigr)

    F_i are the summands of the force on the body (of its push, where the contact has one) but for its friction and damping: a drive,
    a weight, a spring. With what their sum leaves to friction and inertia they balance, so half of all their sizes passes through it:
    the greater of those that act in one direction and those that act in the other. One force alone, with what only effects give
    (``outside``), loads nothing. Where a force is computed after the contact the load is not known there, and none is returned.
    """
    lines = [node for node in function.body if isinstance(node, ast.Assign)]
    sums = {_target(one): one.value for one in lines if isinstance(one.value, ast.BinOp)}
    outside = {_target(one) for one in lines if called(one.value) == "outside"}
    later = {"rate", *map(_target, lines)}
    found = {}
    for one in lines:
        if called(one.value) == CONTACT.name and isinstance(one.value, ast.Call):
            own = [str(ast.literal_eval(word.value)) for word in one.value.keywords if word.arg == "name"]
            forces = _forces_on(one.value, lines, sums, {_target(one), *own})
            used = {name for _, force in forces for name in _names_in(force)}
            taken = {f"{name}_load" for name in (_target(one), *own)} & {*map(_target, lines)}
            if len([force for _, force in forces if ast.unparse(force) not in outside]) > 1 and not used & later and not taken:
                whole = " ".join(f"{sign} ({ast.unparse(force)})" for sign, force in forces)
                sizes = " + ".join(f"abs({ast.unparse(force)})" for _, force in forces)
                found[velocity_of(one.value)] = f"0.5 * ({sizes} + abs({whole.removeprefix('+ ')}))"
        later.discard(_target(one))
    return found


def _target(line: ast.Assign) -> str:
    return ast.unparse(line.targets[0])


def _forces_on(
    contact: ast.Call, lines: Sequence[ast.Assign], sums: Mapping[str, ast.expr], friction: set[str]
) -> list[tuple[str, ast.expr]]:
    """Return the forces on what a contact brakes, each with its sign: but for friction, and what is in proportion to its velocity."""
    velocity = velocity_of(contact)
    given = {keyword.arg: keyword.value for keyword in contact.keywords}
    force = given.get("push", contact.args[1] if len(contact.args) > 1 else None)
    for one in lines if force is None else ():
        if _target(one) == velocity.replace("state.", "rate.", 1):
            force = one.value
    if isinstance(force, ast.Call) and called(force) == BODY.name:
        own = {keyword.arg: keyword.value for keyword in force.keywords}
        force = own.get("force", force.args[0] if force.args else None)
    elif isinstance(force, ast.BinOp) and isinstance(force.op, ast.Div):
        force = force.left
    parts = [] if force is None else _summands(force, sums, "+")
    return [(sign, part) for sign, part in parts if not (friction & _names_in(part) or _is_damping(part, velocity))]


def _summands(node: ast.expr, sums: Mapping[str, ast.expr], sign: str) -> list[tuple[str, ast.expr]]:
    """Return the summands of an expression with their signs; a plain line that is a sum is one of its summands'."""
    other = {"+": "-", "-": "+"}[sign]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return _summands(node.operand, sums, other)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        right = other if isinstance(node.op, ast.Sub) else sign
        return [*_summands(node.left, sums, sign), *_summands(node.right, sums, right)]
    own = sums.get(node.id) if isinstance(node, ast.Name) else None
    if isinstance(own, ast.BinOp) and isinstance(own.op, ast.Add | ast.Sub):
        return _summands(own, sums, sign)
    return [(sign, node)]


def _is_damping(node: ast.expr, velocity: str) -> bool:
    """Whether a force is a velocity times or over parameters."""
    texts = {ast.unparse(one) for one in ast.walk(node) if isinstance(one, ast.Attribute)}
    others = {text for text in texts if not text.startswith("parameter.")}
    return others == {velocity} and not isinstance(node, ast.Call) and _names_in(node) <= {"state", "parameter"}


def _names_in(node: ast.AST) -> set[str]:
    return {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
