"""Parts: lines that are written once, as a function, and written out wherever equations, laws or effects use them."""

from __future__ import annotations

import ast
import copy
import functools
import inspect
from collections.abc import Callable, Sequence
from types import CodeType
from typing import Any, cast

from hjcamp.errors import UsageError, counted, unknown
from hjcamp.model.declare.part_lines import (
    Change,
    called_like,
    computed,
    elements,
    fixed,
    given_to,
    is_part,
    is_text,
    names_in_tree,
    stored,
    targets_of,
)

Function = Callable[..., Any]
MARKS = "hjcamp.model.declare.marks"


def whole_definition(function: Function) -> ast.FunctionDef:
    """Return the definition of a function with every ``part(...)`` in it written out; lines count from its own first.

    Raises ``UsageError`` for a part that is unknown, calls itself, is called with wrong arguments or does not end with
    its one return, for one with a state of its own that is used twice, and for names that clash.
    """
    return _Writer(function, ()).definition


def has_parts(function: Function) -> bool:
    """Return whether a function uses a part."""
    return "part" in function.__code__.co_names


@functools.cache
def whole_code(function: Function) -> CodeType:
    """Return the code of a function with its parts written out, in the file and the lines of the function."""
    if not has_parts(function):
        return function.__code__
    definition = whole_definition(function)
    definition.decorator_list = []
    module = ast.increment_lineno(ast.Module([definition], []), inspect.getsourcelines(function)[1] - 1)
    scope = dict(function.__globals__)
    exec(compile(ast.fix_missing_locations(module), function.__code__.co_filename, "exec"), scope)
    code: CodeType = scope[definition.name].__code__
    return code


def _parsed(lines: Sequence[str]) -> ast.stmt:
    """Return the definition in the lines of a function, wherever it stands; comments and continued lines may stand at the left."""
    if not lines[0][:1].isspace():
        return ast.parse("".join(lines)).body[0]
    block = ast.increment_lineno(ast.parse("".join(["if True:\n", *lines])), -1).body[0]
    assert isinstance(block, ast.If)
    return block.body[0]


class _Writer:
    """Writes out the parts of one function; ``above`` are the functions by which it is used itself."""

    def __init__(self, function: Function, above: tuple[Function, ...]) -> None:
        self.function, self.stack = function, (*above, function)
        lines, self.first = inspect.getsourcelines(function)
        self.file = inspect.getsourcefile(function) or "?"
        definition = _parsed(lines)
        if not isinstance(definition, ast.FunctionDef):
            raise UsageError(f"{self.file}: line {self.first}: a part must be a function (def NAME(...): ...)")
        self.definition = definition
        self.owned: dict[str, str] = {}
        if has_parts(function):
            self.taken = names_in_tree(definition) | {argument.arg for argument in definition.args.args}
            definition.body = self._body(definition.body)

    def _body(self, lines: Sequence[ast.stmt]) -> list[ast.stmt]:
        found: list[ast.stmt] = []
        for line in lines:
            value = line.value if isinstance(line, ast.Assign | ast.Expr | ast.Return) else None
            alone = not isinstance(line, ast.Assign) or len(line.targets) == 1
            if alone and isinstance(value, ast.Call) and is_part(value):
                found += self._written(line, value)
                continue
            for field in ("body", "orelse"):
                if inner := getattr(line, field, None):
                    setattr(line, field, self._body(inner))
            # what is left stands within an expression
            if any(is_part(node) for node in ast.walk(line)):
                raise UsageError(f"{self._where(line)}: write NAME = part(...) on a line of its own")
            found.append(line)
        return found

    def _where(self, line: ast.stmt) -> str:
        return f"{self.file}: line {self.first + line.lineno - 1}"

    def _written(self, line: ast.stmt, call: ast.Call) -> list[ast.stmt]:
        """Return the lines of a part in the place of ``line``."""
        where = self._where(line)
        function = self._found(call, where)
        inner = _Writer(function, self.stack)
        label = f"{where}: part '{function.__name__}'"
        self._own(inner, function, label)
        body = [one for one in copy.deepcopy(inner.definition.body) if not is_text(one)]
        if not body or any(isinstance(node, ast.Return) for one in body[:-1] for node in ast.walk(one)):
            raise UsageError(f"{label}: its one return must be its last line")
        last = body[-1]
        result = last.value if isinstance(last, ast.Return) else None
        body = body[:-1] if isinstance(last, ast.Return) else body
        targets = targets_of(line)
        prefix = f"{called_like(targets[0])}_" if targets else ""
        given = given_to(inner.definition, call, label)
        names = {name: prefix + name for one in body for name in sorted(stored(one))}
        if wrong := sorted(set(names) & set(given)):
            raise UsageError(f"{label}: it assigns its argument '{wrong[0]}'; give that line another name")
        results = [] if result is None else elements(result) if len(targets) > 1 else [result]
        if len(results) != len(targets) and not isinstance(line, ast.Return):
            raise UsageError(f"{label} returns {counted(len(results), 'value')} for {counted(len(targets), 'name')}")
        # a result takes the name that it is given, where the arguments do not use that name themselves
        used = {name for value in given.values() for name in names_in_tree(value)}
        for target, value in zip(targets, results, strict=False):
            if isinstance(target, ast.Name) and target.id not in used and isinstance(value, ast.Name):
                names |= {value.id: target.id} if names.get(value.id) == prefix + value.id else {}
        own = {target.id for target in targets if isinstance(target, ast.Name)}
        lines, replaced = computed(given, prefix)
        new = ({*names.values()} - own) | {name for one in lines for name in stored(one)}
        if clash := sorted(new & self.taken):
            raise UsageError(f"{label}: its '{clash[0]}' is also a name here; write NAME = part(...) with another NAME")
        self.taken |= new
        change = Change(names, replaced)
        lines += [change.visit(one) for one in body]
        results = [change.visit(value) for value in results]
        if isinstance(line, ast.Return):
            lines.append(ast.Return(results[0] if results else None))
        for target, value in zip(targets, results, strict=False):
            if not (isinstance(target, ast.Name) and isinstance(value, ast.Name) and target.id == value.id):
                lines.append(ast.Assign([target], value))
        for one in lines:
            for node in ast.walk(one):
                ast.copy_location(node, line)
        return [ast.fix_missing_locations(one) for one in lines]

    def _found(self, call: ast.Call, where: str) -> Function:
        """Return the function that a part names."""
        if not call.args:
            raise UsageError(f"{where}: part(...) lacks the function that it stands for: part(FUNCTION, ...)")
        text = ast.unparse(call.args[0])
        scope = self.function.__globals__
        found: Any = scope.get(text.split(".")[0])
        for name in text.split(".")[1:]:
            found = getattr(found, name, None)
        if not _may_be_part(found):
            raise unknown("part", text, [name for name, value in scope.items() if _may_be_part(value)], where)
        if found in self.stack:
            chain: list[Any] = [*self.stack[self.stack.index(found) :], found]
            names = " -> ".join(one.__name__ for one in chain)
            raise UsageError(f"{where}: part '{found.__name__}' calls itself ({names})")
        return cast("Callable[..., Any]", found)

    def _own(self, inner: _Writer, function: Function, label: str) -> None:
        """Refuse a second part that sets the same state or memory by its fixed name."""
        set_here = {name: function.__name__ for one in inner.definition.body for name in fixed(one)}
        for name, part in set_here.items():
            if name in self.owned:
                space, own = name.split(".")
                raise UsageError(
                    f"{label}: '{name}' is set by part '{self.owned[name]}' before, and a state of its own serves one "
                    f"part only; take its name as an argument: {space}[{own}]"
                )
            self.owned[name] = part


def _may_be_part(value: Any) -> bool:
    """Return whether ``value`` is a function of lines: no mark, no element."""
    return inspect.isfunction(value) and value.__module__ != MARKS
