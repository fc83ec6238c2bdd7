"""Laws that are read from a table of values at equal distances: one function of a kernel serves all of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot
from typing import Any


@dataclass(frozen=True)
class Table:
    """How a kernel says a method that interpolates a table: an expression in the names of its arguments.

    ``{table}`` in the ``text`` stands for where the values are. ``first`` is the argument with the first of ``count`` values, which
    are neighbours among the effect's parameters.
    """

    first: str
    count: int
    text: str


def interpolated(p, first, count, share, start, factor):  # type: ignore[no-untyped-def]
    """Return ``start`` and ``factor`` times what a table p[first], p[first + 1], ... has at a share of its whole length.

    Piecewise linear, constant beyond both ends. The sum is that of all ``count`` hat functions, of which two differ from 0.
    """
    at = (count - 1.0) * min(max(share, 0.0), 1.0)
    k = min(int(at), count - 2) if at > 0.0 else 0
    before = factor * p[first + k] * max(0.0, 1.0 - abs(at - k))
    return start + before + factor * p[first + k + 1] * max(0.0, 1.0 - abs(at - (k + 1)))


def rooted(value):  # type: ignore[no-untyped-def]
    """Return the positive number h + sqrt(1 + h^2)."""
    return value + hypot(1.0, value)


def table_of(function: Callable[..., Any]) -> Table | None:
    """Return how a kernel says a method by its table; None where it says it by its own text."""
    found: Table | None = getattr(function, "table", None)
    return found
