"""Try each method of a user's effect by itself, where a mistake can still be told by file and line."""

from __future__ import annotations

import functools
import inspect
import math
import re
from collections.abc import Callable, Iterable
from types import CodeType, FunctionType
from typing import Any

import numpy as np

from hjcamp.errors import UsageError
from hjcamp.model.declare.effect import Effect, parameters_of
from hjcamp.model.declare.law import Law, law_function
from hjcamp.model.declare.part import whole_code
from hjcamp.model.files.time_limit import RunLimit, time_limit
from hjcamp.model.files.user_file import is_users, line_in

CALLING_S = 5.0
# For all methods of all effects, with numbers and with units in the place of numbers.
LOOKING_S = 15.0
# Of computing, for one test: the longest of our campaigns takes less than a hundredth of it.
KERNEL_S = 60.0
TRIED = (0.0, 1.0, -1.0, 0.3, -1e-3, 1e6)


def functions_of(effect: type[Effect]) -> list[Callable[..., float]]:
    """Return every method of an effect that a kernel runs."""
    terms = (*effect.terms.values(), *effect.rates.values(), *effect.updates.values(), *effect.starts.values())
    return [term.function for term in terms]


@functools.cache
def check_calls(effect: type[Effect], mathematics: tuple[str, ...]) -> None:
    """Refuse a user's effect with a method that does not end, or that gives no number: called as plain Python."""
    if not is_users(effect.__module__):
        return
    for function in functions_of(effect):
        code = function.__code__
        where = f"{code.co_filename}: line {code.co_firstlineno}: effect {effect.name}, method '{function.__name__}'"
        with time_limit(CALLING_S, where):
            for value in TRIED:
                _call(effect, function, _alone(function, mathematics), value)


def _call(effect: type[Effect], function: Callable[..., float], alone: Callable[..., Any], value: float) -> None:
    """Call a method with its parameters at their defaults and ``value`` for all else."""
    given = [effect.parameters[name].default if name in effect.parameters else value for name in parameters_of(function)]
    try:
        result = alone(*given)
    except (ArithmeticError, ValueError):
        return  # no value there, as 1/0: `effects test` looks at that
    except (Exception, SystemExit) as problem:
        line = line_in(function.__code__.co_filename, problem) or function.__code__.co_firstlineno
        raise UsageError(_told(line, effect, function, f"{type(problem).__name__}: {problem}")) from None
    if not isinstance(result, int | float):
        kind = "nothing" if result is None else f"a {type(result).__name__}"
        raise UsageError(_told(_last_return(function), effect, function, f"it gives {kind}; a number is needed"))


@functools.cache
def check_compiles(effect: type[Effect], mathematics: tuple[str, ...]) -> None:
    """Refuse a user's effect with a method that numba cannot compile to a number, saying which line of whose file."""
    if not is_users(effect.__module__):
        return
    from numba import njit, types

    for function in functions_of(effect):
        compiled: Any = njit(error_model="numpy")(_alone(function, mathematics))
        if not hasattr(compiled, "compile"):
            return  # NUMBA_DISABLE_JIT
        signature = (types.float64,) * len(parameters_of(function))
        try:
            compiled.compile(signature)
        except Exception as problem:  # numba has several families of errors
            line = _line_of(problem, function)
            raise UsageError(_told(line, effect, function, f"numba cannot compile it: {_first_reason(problem)}")) from None
        kind = compiled.overloads[signature].signature.return_type
        if not isinstance(kind, types.Number | types.Boolean):
            said = f"it gives {kind}; a number is needed on every way through it"
            raise UsageError(_told(_last_return(function), effect, function, said))


@functools.cache
def check_law_compiles(law: type[Law], mathematics: tuple[str, ...]) -> None:
    """Refuse a user's controller that numba cannot compile to its results, saying which line of whose file."""
    if not is_users(law.__module__):
        return
    from numba import njit, types

    function = law_function(law, {name: getattr(math, name) for name in mathematics} | {"np": np})
    compiled: Any = njit(error_model="numpy")(function)
    if not hasattr(compiled, "compile"):
        return  # NUMBA_DISABLE_JIT
    numbers = [types.int64 if name == "index" else types.float64 for name in law.samples]
    signature = (*numbers, types.float64[::1], types.float64[::1])
    file = function.__code__.co_filename
    try:
        compiled.compile(signature)
    except Exception as problem:  # numba has several families of errors
        line = _line_of(problem, function)
        raise UsageError(
            f"{file}: line {line}: controller {law.name}: numba cannot compile it: {_first_reason(problem)}"
        ) from None
    kind: Any = compiled.overloads[signature].signature.return_type
    given = [*kind] if isinstance(kind, types.UniTuple | types.Tuple) else [kind]
    if len(given) != len(law.results) or not all(isinstance(one, types.Number | types.Boolean) for one in given):
        line = _last_return(law.step)  # type: ignore[attr-defined]
        raise UsageError(
            f"{file}: line {line}: controller {law.name}: it gives {kind}; "
            f"{len(law.results)} numbers are needed on every way through it: {', '.join(law.results)}"
        )


def limited(method: Callable[..., Any]) -> Callable[..., Any]:
    """Limit a method of a simulator that runs its kernel, where a file of the user's is part of that.

    A kernel does not look at signals, so one that never ends takes its process with it; it says whose code it was.
    """

    @functools.wraps(method)
    def call(self: Any, *given: Any, **named: Any) -> Any:
        if not self.users_files:
            return method(self, *given, **named)
        with RunLimit(KERNEL_S, f"one test with {self.users_files}")():
            return method(self, *given, **named)

    return call


def users_files(parts: Iterable[type]) -> str:
    """Return in words which effects and controllers are files of the user's; empty where none is."""
    kinds = [("effect" if issubclass(one, Effect) else "controller", one) for one in parts if is_users(one.__module__)]
    return " and ".join(f"{kind} {getattr(one, 'name', '')} ({inspect.getfile(one)})" for kind, one in kinds)


def _alone(function: Callable[..., float], mathematics: tuple[str, ...]) -> Callable[..., Any]:
    """Return the function with the names that a kernel gives it, whatever its file imports."""
    names = {name: getattr(math, name) for name in mathematics}
    return FunctionType(whole_code(function), {**names, "__name__": function.__module__}, function.__name__)


def _told(line: int, effect: type[Effect], function: Callable[..., float], reason: str) -> str:
    place = f"{function.__code__.co_filename}: line {line}"
    return f"{place}: effect {effect.name}, method '{function.__name__}': {reason}"


def _first_reason(problem: BaseException) -> str:
    """Return the sentence of numba's long text that says what is wrong."""
    lines = [line.strip(" -") for line in str(problem).splitlines()]
    skipped = (
        "Failed in",
        "File ",
        "During:",
        "[1]",
        "[2]",
        "No implementation of",
        "There are",
        "<source",
        "def ",
        "Overload",
    )
    said = [line for line in lines if line and not line.startswith(skipped)]
    named = [line for line in lines if line.startswith("No implementation of")]
    return " ".join((named or said or [type(problem).__name__])[0].split())[:200]


def _line_of(problem: BaseException, function: Callable[..., float]) -> int:
    """Return the line that numba names, in one of its two ways, else where the function begins."""
    line = getattr(getattr(problem, "loc", None), "line", None)
    named = re.search(re.escape(function.__code__.co_filename) + r"\D{0,9}(\d+)", str(problem))
    return line or int(named[1] if named else function.__code__.co_firstlineno)


def _last_return(function: Callable[..., float]) -> int:
    code: CodeType = function.__code__
    lines, first = inspect.getsourcelines(function)
    found = [first + number for number, text in enumerate(lines) if text.strip().startswith("return")]
    return found[-1] if found else code.co_firstlineno
