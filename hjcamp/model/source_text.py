"""Text of generated functions: the statements that a result needs, terms behind gates, functions copied from effects."""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Callable, Sequence

from hjcamp.model.part import whole_definition

GATES = "gates"
INLINED = ("predict", "glide", "correct", "contact", "locking", "facing", "faced", "limiting", "readings")
ENTRIES = ("rates", "begin", "signals")


def live(statements: Sequence[str], last: str) -> list[str]:
    """Return those one-line statements whose results reach the text ``last``, in order."""
    wanted = names_in(last)
    kept = []
    for line in reversed(statements):
        target, names = assigned(line)
        if target in wanted:
            kept.append(line)
            wanted |= names
    return kept[::-1]


@functools.lru_cache(maxsize=4096)
def assigned(line: str) -> tuple[str, frozenset[str]]:
    """Return the name that a one-line statement sets, and all names in it."""
    tree = ast.parse(line).body[0]
    assignment = tree.body[0] if isinstance(tree, ast.If) else tree
    assert isinstance(assignment, ast.Assign)
    return ast.unparse(assignment.targets[0]), frozenset(names_in(line))


def behind_one_test(lines: Sequence[str]) -> list[str]:
    """Return the statements with neighbours behind gates under one test: most slots have no effect most of the time."""
    found: list[str] = []
    gated: list[tuple[int, str]] = []
    for line in [*lines, ""]:
        mask = re.match(rf"if {GATES} & (\d+): ", line)
        if mask:
            gated.append((int(mask[1]), line))
            continue
        if len(gated) > 1:
            found.append(f"if {GATES} & {sum({bit for bit, _ in gated})}:")
        found += [f"    {one}" if len(gated) > 1 else one for _, one in gated]
        gated = []
        found += [line] if line else []
    return found


def names_in(text: str) -> set[str]:
    """Return the names in a text of Python, its keywords among them: parsing it takes far longer."""
    return set(re.findall(r"\b[A-Za-z_]\w*", text))


def copied_function(name: str, function: Callable[..., float]) -> str:
    """Return a function's source under another name, without its decorators and annotations."""
    definition = whole_definition(function)
    definition.name = name
    definition.decorator_list = []
    definition.returns = None
    for argument in definition.args.args:
        argument.annotation = None
    return "@inlined\n" + ast.unparse(definition) + "\n\n"


def function_source(signature: str, lines: Sequence[str]) -> str:
    """Return the source of a compiled function; those of every step are inlined, those that Python calls are cached."""
    name = signature.split("(")[0]
    mark = "inlined" if name in INLINED else "entry" if name in ENTRIES else "hot"
    return f"@{mark}\ndef {signature}:\n" + "".join(f"    {line}\n" for line in lines or ["pass"]) + "\n\n"
