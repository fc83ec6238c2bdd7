"""What a sweep makes small: a number for each run, an indicator or a formula of several."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hjcamp.errors import HjcampError, UsageError, counted, shown, unknown
from hjcamp.report.runs.indicators import FURTHER, INDICATORS

if TYPE_CHECKING:
    import polars as pl

KNOWN = (*INDICATORS, *FURTHER)
OPERATORS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
FUNCTIONS: dict[str, Callable[..., float]] = {"abs": abs, "sqrt": math.sqrt, "max": max, "min": min}
SHOWN = 3
LONGEST = 300
#: Values of indicators at one of which a formula that can be a number is one.
TRIED = (0.7, -1.3, 0.0)


@dataclass(frozen=True)
class Objective:
    """A formula of indicators: numbers, ``+ - * / **``, brackets, ``abs``, ``sqrt``, ``max``, ``min``."""

    text: str
    names: tuple[str, ...]
    formula: ast.expr

    def of(self, indicators: pl.DataFrame) -> float:
        r"""Return the value of a run, the mean over its n tests of the formula f of each test's indicators.

        .. math:: J = \tfrac{1}{n} \sum_i f(x_i)

        ``indicators`` has one row for each test (`indicators_frame`). Raises ``HjcampError`` where a test lacks an
        indicator, or where the value is no finite number.
        """
        rows = indicators.select("condition", *self.names).to_dicts()
        if not rows:
            raise HjcampError(f"objective={self.text}: the run has no test")
        for name in self.names:
            lacking = list(dict.fromkeys(str(row["condition"]) for row in rows if row[name] is None))
            if lacking:
                count = sum(row[name] is None for row in rows)
                more = f" and {len(lacking) - SHOWN} more" if len(lacking) > SHOWN else ""
                raise HjcampError(
                    f"objective={self.text}: {counted(count, 'test has', 'tests have')} no {name} "
                    f"({', '.join(lacking[:SHOWN])}{more}); choose conditions that have it with conditions=NAME"
                )
        value = sum(_tried(self.formula, row) for row in rows) / len(rows)
        if not math.isfinite(value):
            raise HjcampError(f"objective={self.text} is no finite number in this run")
        return value


def read_objectives(given: Any) -> tuple[Objective, ...]:
    """Return the objectives that ``objective=`` names, none for None; ``UsageError`` for what is no formula of indicators."""
    if given is None:
        return ()
    texts = given if isinstance(given, list | tuple) else [given]
    if not texts:
        raise UsageError(f"objective=[] names nothing. Allowed: {', '.join(KNOWN)}, and formulas of them")
    return tuple(_read(text) for text in texts)


def _read(text: Any) -> Objective:
    said = str(text).strip()
    if len(said) > LONGEST:
        raise UsageError(f"objective={shown(text)}: a formula of at most {LONGEST} characters is read")
    try:
        formula = ast.parse(said, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise UsageError(f"objective={shown(text)} is no formula; write one such as rmse1_deg + 0.1*e_max_deg") from None
    names: dict[str, None] = {}
    _check(formula, said, names)
    if not names:
        raise UsageError(f"objective={said} names no indicator. Allowed: {', '.join(KNOWN)}, and formulas of them")
    if not any(math.isfinite(_tried(formula, dict.fromkeys(names, one))) for one in TRIED):
        raise UsageError(f"objective={said} is no finite number, whatever the indicators are")
    return Objective(said, tuple(names), formula)


def _tried(formula: ast.expr, row: dict[str, float]) -> float:
    try:
        return float(_value(formula, row))
    except (ArithmeticError, ValueError, TypeError):
        return math.nan


def _check(node: ast.expr, text: str, names: dict[str, None]) -> None:
    """Refuse what is not arithmetic; note the names of indicators."""
    match node:
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            return
        case ast.Name(id=name):
            if name not in KNOWN:
                raise unknown("indicator", name, KNOWN, f"objective={text}")
            names[name] = None
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=inner):
            _check(inner, text, names)
        case ast.BinOp(left=left, op=sign, right=right) if type(sign) in OPERATORS:
            _check(left, text, names)
            _check(right, text, names)
        case ast.Call(func=ast.Name(id=function), args=arguments, keywords=[]) if function in FUNCTIONS and arguments:
            for one in arguments:
                _check(one, text, names)
        case _:
            raise UsageError(
                f"objective={text}: '{ast.unparse(node)[:40]}' is no number; allowed are indicators, numbers, + - * / **, "
                f"brackets, {', '.join(FUNCTIONS)}"
            )


def _value(node: ast.expr, row: Mapping[str, Any]) -> float:
    match node:
        case ast.Constant(value=value):
            return float(value)  # type: ignore[arg-type]
        case ast.Name(id=name):
            return float(row[name])
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner, row)
        case ast.UnaryOp(operand=inner):
            return _value(inner, row)
        case ast.BinOp(left=left, op=sign, right=right):
            return OPERATORS[type(sign)](_value(left, row), _value(right, row))
        case ast.Call(func=ast.Name(id=function), args=arguments):
            return FUNCTIONS[function](*(_value(one, row) for one in arguments))
    raise AssertionError(node)
