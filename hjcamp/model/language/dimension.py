"""Dimensions as powers of base quantities, and those of products of SI units such as ``kg*m/s^2``."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping

#: Base quantities in the order in which they are written, with their units.
BASE = {
    "[mass]": "kg", "[length]": "m", "[time]": "s", "[current]": "A",
    "[temperature]": "K", "[substance]": "mol", "[luminosity]": "cd",
}  # fmt: skip


#: Words, numbers and what joins them; a number runs into no word.
PRODUCT = re.compile(r"(?:[A-Za-z]+(?![\d.])|[\d.]+(?![A-Za-z])|[*/^()-]){1,60}")
MOST_POWER = 20.0


class Dimension(Mapping[str, float]):
    """Powers of base quantities, by name: ``[length]`` 1 and ``[time]`` -1 are those of a speed."""

    def __init__(self, powers: Mapping[str, float]) -> None:
        self._powers = {name: powers[name] for name in sorted(powers, key=_place) if powers[name]}
        self._hash = hash(tuple(self._powers.items()))

    def __getitem__(self, name: str) -> float:
        return self._powers[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._powers)

    def __len__(self) -> int:
        return len(self._powers)

    def __hash__(self) -> int:
        return self._hash

    def __mul__(self, other: Dimension) -> Dimension:
        if not self or not other:
            return self or other
        return Dimension({name: self.get(name, 0.0) + other.get(name, 0.0) for name in (*self, *other)})

    def __pow__(self, power: float) -> Dimension:
        return Dimension({name: one * power for name, one in self.items()})

    def __truediv__(self, other: Dimension) -> Dimension:
        return self * other**-1.0

    def __str__(self) -> str:
        """In base units, such as ``kg*m/s^2``."""
        over = [BASE.get(name, name) + (f"^{power:g}" if power != 1 else "") for name, power in self.items() if power > 0]
        under = [BASE.get(name, name) + (f"^{-power:g}" if power != -1 else "") for name, power in self.items() if power < 0]
        below = under[0] if len(under) == 1 else f"({'*'.join(under)})"
        return ("*".join(over) or "1") + (f"/{below}" if under else "")


def product_of_units(text: str) -> Dimension | None:
    """Return the dimension of a product of powers of SI units, None for a text that is written in another way."""
    if not PRODUCT.fullmatch(text):
        return None
    try:
        return _of_node(ast.parse(text.replace("^", "**"), mode="eval").body)
    except (SyntaxError, LookupError, TypeError, ValueError, OverflowError, RecursionError, MemoryError):
        return None


def _of_node(node: ast.expr) -> Dimension:
    if isinstance(node, ast.Name):
        return SYMBOLS[node.id]
    if isinstance(node, ast.Constant) and node.value == 1 and type(node.value) is int:
        return Dimension({})
    if isinstance(node, ast.BinOp):
        left = _of_node(node.left)
        if isinstance(node.op, ast.Pow):
            power = float(ast.literal_eval(node.right))
            if abs(power) <= MOST_POWER:
                return left**power
        if isinstance(node.op, ast.Mult):
            return left * _of_node(node.right)
        if isinstance(node.op, ast.Div):
            return left / _of_node(node.right)
    raise ValueError


def _place(name: str) -> tuple[int, str]:
    return list(BASE).index(name) if name in BASE else len(BASE), name


def _of(mass: float = 0.0, length: float = 0.0, time: float = 0.0, current: float = 0.0) -> Dimension:
    return Dimension({"[mass]": mass, "[length]": length, "[time]": time, "[current]": current})


#: The coherent SI units by their symbols.
SYMBOLS = {unit: Dimension({name: 1.0}) for name, unit in BASE.items()} | {
    "rad": _of(), "Hz": _of(time=-1), "N": _of(1, 1, -2), "Pa": _of(1, -1, -2), "J": _of(1, 2, -2), "W": _of(1, 2, -3),
    "C": _of(time=1, current=1), "V": _of(1, 2, -3, -1), "ohm": _of(1, 2, -3, -2), "F": _of(-1, -2, 4, 2), "T": _of(1, 0, -2, -1),
    "Wb": _of(1, 2, -2, -1), "H": _of(1, 2, -2, -2),
}  # fmt: skip
