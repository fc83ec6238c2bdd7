"""Units of a plant's equations: each line is evaluated with amounts that carry their dimension."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hjcamp.errors import UsageError, unknown
from hjcamp.model.declare.plant import Plant
from hjcamp.model.declare.port import KINDS
from hjcamp.model.language.amount import Amount, dimension
from hjcamp.model.language.amount_formula import MATHEMATICS, evaluated, names

if TYPE_CHECKING:
    from hjcamp.model.declare.statement import Statement

USUAL = (
    "1",
    "m",
    "m/s",
    "m/s^2",
    "1/s",
    "kg",
    "N",
    "N/m",
    "N*s/m",
    "N/m^3",
    "N*s^2/m^2",
    "N*m",
    "m/N",
    "Pa",
    "Pa/s",
    "Pa/m^3",
    "m^3/(s*Pa)",
    "m^3",
    "m^3/s",
    "m^3/Pa",
    "V",
    "V/s",
    "A",
    "W",
    "K",
)
# What stands for lines of its own, and no value.
MARKS = (*KINDS, "slot", "signal", "outside", "part")
MODULES = ("np", "numpy", "math", "jnp", "scipy")
FUNCTIONS = ", ".join(("abs", "min", "max", *MATHEMATICS))
_PREFIXES = {"s_": "state", "p_": "parameter", "u_": "input"}


class Units:
    """The unit of every name in a plant's equations, found line by line."""

    def __init__(self, plant: type[Plant]) -> None:
        self.plant = plant
        self.scope: dict[str, Any] = names()
        self._known = len(self.scope)
        self._done = 0
        groups: tuple[tuple[str, Mapping[str, Any]], ...]
        groups = (("s_", plant.states), ("p_", plant.parameters), ("u_", plant.inputs))
        item: Any
        own: dict[Any, set[str]] = {}
        for prefix, group in groups:
            for position, (name, item) in enumerate(group.items()):
                try:
                    dims = dimension(item.unit)
                except UsageError as problem:
                    raise UsageError(f"plant {plant.name or plant.__name__}, {name}: {problem}") from None
                own.setdefault(dims, set()).add(item.unit)
                self.scope[prefix + name] = Amount(0.5 + 0.01 * position, dims)
        self._written = {dimension(unit): unit for unit in USUAL}
        for dims, units in own.items():
            # Its own word for a quantity is the plant's, where it has one; a turn has no dimension, and stands for no ratio.
            if dims not in self._written or (len(units) == 1 and "rad" not in next(iter(units))):
                self._written[dims] = min(units, key=len)
        for velocity in plant.inputs:
            self.scope.setdefault(f"u_{velocity}", Amount(1.0, dimension("1")))

    def follow(self, statements: Sequence[Statement]) -> None:
        """Evaluate the lines that are new since the last call; refuse a unit that does not fit."""
        for one in statements[self._done :]:
            self._done += 1
            where = f"plant {self.plant.name or self.plant.__name__}, line {one.line}"
            amount = self.value(one.expression, f"{where}, '{one.target}'")
            if one.mark == "rate":
                self._rate(one, amount, where)
                self.scope[f"d_{one.target}"] = amount
                continue
            if one.unit and one.unit != str(amount.dims):
                wanted = dimension(one.unit)
                if wanted != amount.dims and not amount.literal:
                    raise UsageError(
                        f"{where}: '{one.target}' is in {self.written(amount.dims)}, but it should be in {one.unit}"
                    )
                amount = Amount(amount.value, wanted)
            self.scope[one.target] = amount

    def _rate(self, one: Statement, amount: Amount, where: str) -> None:
        if one.target not in self.plant.states:
            raise unknown("state", one.target, self.plant.states, where)
        unit = self.plant.states[one.target].unit
        wanted = dimension(f"({unit})/s" if unit != "1" else "1/s")
        if wanted != amount.dims and not amount.literal:
            raise UsageError(
                f"{where}: rate.{one.target} is in {self.written(amount.dims)}, but the state '{one.target}' is in {unit}, "
                f"so its rate must be in {self.written(wanted)}"
            )

    def value(self, expression: str, where: str) -> Amount:
        """Return the amount of an expression in the lines' own names."""
        for name in dict.fromkeys(re.findall(r"\b[A-Za-z_]\w*", expression)):
            if name in self.scope or name in ("if", "else", "and", "or", "not", "True", "False"):
                continue
            if name.startswith("u_direction_"):
                self.scope[name] = Amount(1.0, dimension("1"))
                continue
            raise self._unknown(name, where)
        try:
            return evaluated(expression, self.scope)
        except UsageError as problem:
            raise UsageError(f"{where}: {problem}") from None
        except (ArithmeticError, ValueError) as problem:
            raise UsageError(f"{where}: cannot be evaluated at ordinary values: {problem}") from None

    def _unknown(self, name: str, where: str) -> UsageError:
        kind = _PREFIXES.get(name[:2])
        if kind == "state":
            return unknown("state", name[2:], self.plant.states, where)
        if kind == "parameter":
            return unknown("parameter", name[2:], self.plant.parameters, where)
        if kind == "input":
            return unknown("input", name[2:], self.plant.inputs, where)
        if name.startswith("d_"):
            return UsageError(f"{where}: rate.{name[2:]} must be given in a line above, where it is read (no algebraic loops)")
        if name in MODULES:
            return UsageError(f"{where}: '{name}.' is not needed: write sin(...), sqrt(...) alone; known are {FUNCTIONS}")
        if name in MARKS:
            return UsageError(
                f"{where}: {name}(...) stands alone on its line: give it a name, NAME = {name}(...), and use that"
            )
        plant = self.plant
        spaces: dict[str, Mapping[str, Any]] = {"state": plant.states, "parameter": plant.parameters, "drive": plant.inputs}
        for space, declared in spaces.items():
            if name in declared:
                return UsageError(f"{where}: '{name}' is written {space}.{name}")
        own = [f"{space}.NAME" for space in spaces]
        own += [one for one in list(self.scope)[self._known :] if one[:2] not in _PREFIXES and one[:2] not in ("d_", "__")]
        known = f"a name must be computed in a line above: no algebraic loops; functions are {FUNCTIONS}"
        return unknown("name", name, own, f"{where} ({known})")

    def of_rule(self, rule: str, given: Mapping[str, str], where: str) -> str:
        """Return the unit that a product of arguments has, such as ``push/velocity``."""
        if rule == "1":
            return "1"
        scope = {name: self.value(expression, where) for name, expression in given.items()}
        return self.written(evaluated(rule, {**self.scope, **scope}).dims)

    def written(self, dims: Any) -> str:
        """Return a dimension as people write it: in the plant's own units where one or two of them make it."""
        return self._written.get(dims) or self._ratio(dims) or str(dims)

    def _ratio(self, dims: Any) -> str:
        """Return a dimension as a unit of the plant by another one's power, ``N/m^3``, or as one over it; else nothing."""
        pure = dimension("1")
        simple = {one: unit for one, unit in self._written.items() if unit.isalpha()}
        for power in (1, 2, 3):
            for below, unit in simple.items():
                under = unit if power == 1 else f"{unit}^{power}"
                above = simple.get(dims * below**power, "1" if dims * below**power == pure else "")
                if above:
                    return f"{above}/{under}"
        return ""
