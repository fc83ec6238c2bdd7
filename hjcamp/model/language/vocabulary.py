"""Read a plant's marked equations: the one vocabulary of slots, signals, states, inputs and parameters."""

from __future__ import annotations

import ast
import inspect
import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.element import BODY, CONTACT, ELEMENTS, TRANSMISSION, called, expand
from hjcamp.model.declare.own_names import OF_LAWS, free_name, of_effects
from hjcamp.model.declare.parameter import Contact
from hjcamp.model.declare.part import whole_definition
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import Port
from hjcamp.model.declare.statement import Statement
from hjcamp.model.files.cached import cached
from hjcamp.model.language.amount import dimension
from hjcamp.model.language.completion import completed, driven_in, has_push, loads_in, masses_in, positions_in, velocity_of
from hjcamp.model.language.equation_units import Units
from hjcamp.model.language.short_names import written_out

NAMESPACES = {"state": "s_", "parameter": "p_", "drive": "u_", "rate": "d_"}

# Names of the functions into which the lines of equations are written (`hjcamp.model.compile.function_sources`, `step_source`).
TAKEN = frozenset({"a", "abs", "before", "direction", "f", "gates", "int", "out", "p", "row", "steps", "z"})


@dataclass(frozen=True)
class Vocabulary:
    """What a plant offers to effects: its statements in order, its places, and the names each place may use.

    ``unheld`` has the rate of each contact's velocity as it is while nothing is held; ``pushed``: contacts are given their push.
    """

    plant: type[Plant]
    statements: tuple[Statement, ...]
    readings: tuple[str, ...]
    limits: tuple[tuple[str, str, str], ...]
    ports: Mapping[str, Port] = field(default_factory=dict)
    unheld: Mapping[str, str] = field(default_factory=dict)
    pushed: bool = True

    @cached_property
    def slots(self) -> dict[str, Statement]:
        """Every slot by name, in order of computation."""
        return {line.target: line for line in self.statements if line.mark == "slot"}

    @cached_property
    def signals(self) -> dict[str, Statement]:
        """Every signal and slot by name, in order of computation."""
        return {line.target: line for line in self.statements if line.mark in ("slot", "signal")}

    @cached_property
    def changeable(self) -> tuple[str, ...]:
        """The plant's parameters that an effect may act on like on a slot: those that share no name with a signal."""
        return tuple(name for name in self.plant.parameters if name not in self.signals)

    @cached_property
    def contacts(self) -> tuple[Contact, ...]:
        """Where dry friction holds, in order: of each place of that kind."""
        found = [port for port in self.ports.values() if port.kind == CONTACT.name]
        names = ("velocity", "push", "static", "locks", "direction", "friction")
        return tuple(Contact(port.name, *(port.names[name] for name in names)) for port in found)

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
        if called(node) == "limited":
            value, low, high = (ast.unparse(argument) for argument in node.args)
            # a float: numba would compile the function anew for each whole number
            node.args.append(ast.Constant(float(3 ** len(self.limits))))
            self.limits.append((value, low, high))
        return node


@cached
def read_vocabulary(plant: type[Plant]) -> Vocabulary:
    """Parse ``plant.equations`` into statements; the docstring and comments are skipped.

    Parts are written out where they stand. Raises ``UsageError`` for what is no assignment, an element that is not as it
    should be, and a unit that does not fit.
    """
    equations = getattr(plant, "equations", None)
    if not inspect.isfunction(equations):
        raise UsageError(f"{inspect.getfile(plant)}: plant {plant.name}: it has no function 'equations'")
    first = inspect.getsourcelines(equations)[1]
    if equations.__name__ == "<lambda>":
        raise UsageError(f"{inspect.getfile(plant)}: line {first}: plant {plant.name}: 'equations' is no function")
    function = _with_free_names(written_out(whole_definition(equations), tuple(NAMESPACES)))
    reader = _Reader(plant, first, [called(node.value) for node in function.body if isinstance(node, ast.Assign)])
    reader.called = {
        node.func.id for node in ast.walk(function) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    reader.masses, reader.driven, reader.positions = masses_in(function), driven_in(function), positions_in(function)
    reader.loads = loads_in(function)
    reader.given_push = bool(plant.ports) or any(has_push(node) for node in ast.walk(function) if called(node) == CONTACT.name)
    for node in function.body:
        reader.read(node)
    return reader.vocabulary()


def _with_free_names(function: ast.FunctionDef) -> ast.FunctionDef:
    """Return the equations with plain lines that are called like something of the compiled model's own (p, out) called otherwise.

    What effects may use keeps its name.
    """
    lines = [node for node in function.body if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)]
    seen = {"slot", "signal", "outside", *ELEMENTS}
    plain = {node.targets[0].id for node in lines if called(node.value) not in seen}  # type: ignore[attr-defined]
    clash = plain & (TAKEN - {"abs", "int"})
    for node in ast.walk(function):
        if isinstance(node, ast.Name) and node.id in clash:
            node.id = f"{node.id}_"
    return function


def _find_next_stores(ports: dict[str, Port]) -> None:
    """Let each store know the slot of what is lost by the one into which a path leads from it."""
    stores = {port.names["level"]: port for port in ports.values() if port.kind == "store" and "level" in port.names}
    for path in [port for port in ports.values() if port.kind == "path"]:
        above, below = (stores.get(path.names.get(side, "")) for side in ("upstream", "downstream"))
        if above and below and "loss" in below.names:
            ports[above.name] = above.but({"loss_below": below.names["loss"]})


def _find_partitions(plant: type[Plant], ports: dict[str, Port]) -> None:
    """Add a place between every two stores of one unit that no path joins."""
    needed = {"level", "loss", "inflow"}
    stores = [port for port in ports.values() if port.kind == "store" and not port.lacks(needed)]
    paths = [port.names for port in ports.values() if port.kind == "path"]
    joined = [{names.get("upstream"), names.get("downstream")} for names in paths]
    for one, other in itertools.combinations(stores, 2):
        levels = [port.names["level"] for port in (one, other)]
        units = {plant.states[level].unit if level in plant.states else level for level in levels}
        name = f"{one.name}_and_{other.name}"
        if len(units) == 1 and set(levels) not in joined and name not in ports:
            ports[name] = Port(
                "partition", name=name, subsystem=one.subsystem,
                level=levels[0], level_beyond=levels[1], loss=one.names["loss"], loss_beyond=other.names["loss"],
                like={"loss": one.names["inflow"], "loss_beyond": other.names["inflow"]},
            )  # fmt: skip


def _check_contacts(plant: type[Plant], ports: Mapping[str, Port], statements: Sequence[Statement]) -> None:
    """Refuse a contact that lacks a name, two of one velocity or direction, and the regime of what is no contact."""
    where = f"plant {plant.name or plant.__name__}"
    found = {port.name: port for port in ports.values() if port.kind == CONTACT.name}
    for port in found.values():
        if lacks := port.lacks({"velocity", "push", "static", "locks", "direction"}):
            raise UsageError(f"{where}: contact '{port.name}' lacks {', '.join(sorted(lacks))}")
        wanted = f"direction_{port.name}" if len(found) > 1 else "direction"
        if port.names["direction"] != wanted:
            raise UsageError(f"{where}: the direction of contact '{port.name}' must be '{wanted}'")
    velocities = [port.names["velocity"] for port in found.values()]
    for velocity in velocities:
        if velocities.count(velocity) > 1:
            raise UsageError(
                f"{where}: two contacts have the velocity '{velocity}'; what rubs at one speed is one contact, its friction the sum"
            )
    for one in statements:
        for name in re.findall(r"\bu_(direction\w*)", one.expression):
            if name == "direction" and len(found) > 1:
                own = " or ".join(f"drive.direction_{contact}" for contact in found)
                raise UsageError(f"{where}, line {one.line}: drive.direction: of which contact? Write {own}")
            if name != "direction" and name.removeprefix("direction_") not in found:
                raise unknown("contact", name.removeprefix("direction_"), found, f"{where}, line {one.line}")
            if name != "direction" and len(found) == 1:
                raise UsageError(f"{where}, line {one.line}: drive.{name}: there is one contact, write drive.direction")


class _Reader:
    """Reads the equations of a plant line by line; elements are written out where they stand."""

    def __init__(self, plant: type[Plant], first: int, calls: list[str]) -> None:
        self.plant, self.first = plant, first
        declared = [port.kind for port in plant.ports.values()]
        self.several = (calls + declared).count(CONTACT.name) > 1
        self.rename = _Rename()
        self.statements: list[Statement] = []
        self.readings: tuple[str, ...] = ()
        self.held: dict[str, str] = {}
        self.pushed: dict[str, bool] = {}
        self.ports = dict(plant.ports)
        self.units: Any = None
        self.masses: dict[str, str] = {}
        self.driven: dict[str, str] = {}
        self.positions: dict[str, str] = {}
        self.loads: dict[str, str] = {}
        self.given_push = True
        self.called: set[str] = set()
        states, inputs = list(plant.states), list(plant.inputs)
        named = {"state": states, "rate": states, "parameter": list(plant.parameters), "drive": inputs}
        self.taken = TAKEN | {f"{NAMESPACES[kind]}{name}" for kind, names in named.items() for name in names}

    def read(self, node: ast.stmt) -> None:
        """Take one line of the equations."""
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            return
        number = self.first + node.lineno - 1
        where = f"plant {self.plant.name or self.plant.__name__}, line {number}"
        if isinstance(node, ast.Return):
            elements = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
            self.readings = tuple(ast.unparse(element) for element in elements if element is not None)
            return
        if not isinstance(node, ast.Assign) or len(node.targets) != 1:
            raise UsageError(
                f"{where}: equations may hold assignments only (NAME = ..., rate.STATE = ...; A if CONDITION else B)"
            )
        target = node.targets[0]
        of_rate = isinstance(target, ast.Attribute)
        if of_rate and not (isinstance(target.value, ast.Name) and target.value.id == "rate"):  # type: ignore[attr-defined]
            raise UsageError(f"{where}: '{ast.unparse(target)}' cannot be assigned; write rate.STATE = ... or NAME = ...")
        if not of_rate and not isinstance(target, ast.Name):
            raise UsageError(f"{where}: '{ast.unparse(target)}' cannot be assigned; one name for each line")
        name = target.attr if isinstance(target, ast.Attribute) else ast.unparse(target)
        if called(node.value) in ELEMENTS:
            self._element(node.value, name, of_rate, where, number)  # type: ignore[arg-type]
        else:
            self._add(name, node.value, "rate" if of_rate else "plain", where, number)

    def _element(self, call: ast.Call, name: str, of_rate: bool, where: str, number: int) -> None:
        if called(call) == CONTACT.name:
            call = completed(call, "mass", self.masses.get(velocity_of(call)))
            call = completed(call, "travel", self.positions.get(velocity_of(call)))
            call = completed(call, "load", self.loads.get(velocity_of(call)))
        elif called(call) == BODY.name:
            call = completed(call, "position", self.positions.get(f"state.{name}"))
        elif called(call) == TRANSMISSION.name:
            call = completed(call, "driven", self.driven.get(name))
        plain = {one.target for one in self.statements if one.mark == "plain"}
        place = expand(call, name, name if of_rate else "", self.several, where, plain, self.given_push)
        port = place.port
        if port.kind == BODY.name and "position" in port.names and "angle" not in port.names:
            turns = dimension(self._unit_of("position", place.given, where)) == dimension("rad")
            port = port.but({"angle": port.names["position"]} if turns else {})
        if port.name in self.ports:
            raise UsageError(f"{where}: two places are called '{port.name}'; give one of them name='...'")
        self.ports[port.name] = port
        for target, line in place.lines:
            unit = self._unit_of(line.unit, place.given, where) if line.unit else ""
            value = ast.parse(line.expression, mode="eval").body
            self._store(Statement(target, self._renamed(value), line.mark, unit, line.text, number), where)
        if called(call) == CONTACT.name:
            self.held[port.names["velocity"]] = port.names["direction"]
            self.pushed[port.name] = has_push(call)
        if of_rate:
            self._add(name, ast.parse(place.rate, mode="eval").body, "rate", where, number)

    def _add(self, name: str, value: ast.expr, mark: str, where: str, number: int) -> None:
        kind = called(value)
        unit = text = ""
        if isinstance(value, ast.Call) and kind in ("slot", "signal", "outside"):
            mark = "slot" if kind == "outside" else kind
            given = value.args if kind == "outside" else value.args[1:]
            try:
                words = [str(ast.literal_eval(argument)) for argument in given]
            except ValueError:
                raise UsageError(f"{where}: unit and text of {kind}(...) must be texts in quotes") from None
            if not words:
                raise UsageError(
                    f'{where}: {kind}(...) lacks its unit, such as {kind}({"" if kind == "outside" else "VALUE, "}"N")'
                )
            unit, text = words[0], words[1] if len(words) > 1 else "outside force" if kind == "outside" else ""
            value = ast.Constant(0.0) if kind == "outside" else value.args[0]
        self._store(Statement(name, self._renamed(value), mark, unit, text, number), where)

    def _renamed(self, value: ast.expr) -> str:
        return ast.unparse(self.rename.visit(value))

    def _store(self, statement: Statement, where: str) -> None:
        if any(
            one.target == statement.target and (one.mark == "rate") == (statement.mark == "rate") for one in self.statements
        ):
            raise UsageError(
                f"{where}: '{statement.target}' is assigned twice; give what the second line computes a name of its own"
            )
        if statement.mark != "rate" and statement.target in self.taken:
            raise UsageError(
                f"{where}: '{statement.target}' is a name that the compiled model has for itself; call this line otherwise"
            )
        why = "is a name that laws use" if statement.target in OF_LAWS else ""
        if statement.mark in ("slot", "signal"):
            why = why or of_effects(statement.target)
        if statement.target in self.called.difference(ELEMENTS, ("slot", "signal", "outside", "part")):
            why = "is called in these equations"
        if why and statement.mark != "rate":
            raise UsageError(
                f"{where}: '{statement.target}' {why}; call this line otherwise, such as '{free_name(statement.target)}'"
            )
        self.statements.append(statement)

    def _unit_of(self, rule: str, given: Mapping[str, str], where: str) -> str:
        self.units = self.units or Units(self.plant)
        self.units.follow(self.statements)
        return str(
            self.units.of_rule(
                rule,
                {key: self._renamed(ast.parse(text, mode="eval").body) for key, text in given.items() if text and key in rule},
                where,
            )
        )

    def vocabulary(self) -> Vocabulary:
        """Return what has been read."""
        statements = [self._guarded(one) for one in self.statements]
        readings = self.readings or tuple(item.sensor for item in self.plant.measured.values())
        limits = tuple(self.rename.limits)
        _find_next_stores(self.ports)
        _find_partitions(self.plant, self.ports)
        _check_contacts(self.plant, self.ports, statements)
        rates = {one.target: one.expression for one in self.statements if one.mark == "rate"}
        unheld = {velocity: rates[velocity] for velocity in self.held if velocity in rates}
        given, lacking = ([name for name, one in self.pushed.items() if one is has] for has in (True, False))
        if given and lacking:
            raise UsageError(
                f"plant {self.plant.name or self.plant.__name__}: contact '{lacking[0]}' has no push and '{given[0]}' has one: "
                "give each contact its push, or none (it is found from the rates then)"
            )
        return Vocabulary(self.plant, tuple(statements), readings, limits, self.ports, unheld, not lacking)

    def _guarded(self, one: Statement) -> Statement:
        if one.mark == "rate" and one.target in self.held:
            return replace(one, expression=f"{one.expression} if u_{self.held[one.target]} != 0.0 else 0.0")
        return one
